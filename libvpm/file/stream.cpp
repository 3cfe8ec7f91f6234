#include "libvpm/file/stream.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm::file {
namespace {

namespace fs = std::filesystem;

class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return number_; }

 private:
  int number_;
};

[[noreturn]] void cannot_write(const std::string& path, const std::string& why) {
  throw Error(
      ErrorKind::cannot_write,
      "cannot write " + (path == "-" ? std::string("to standard output") : path) + ": " + why);
}
[[noreturn]] void cannot_write(const std::string& path, int fault) {
  cannot_write(path, std::string(std::strerror(fault)));
}

void write_to(int descriptor, std::span<const std::byte> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) cannot_write(path, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void sync(int descriptor, const std::string& path) {
  // Some file systems cannot sync (EINVAL, ENOTSUP); then there is nothing more to be had.
  if (::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP) cannot_write(path, errno);
}

// The temporary file of the write under way. A signal handler reads it, hence no std::string; one
// file is written at a time, so one is enough.
char unfinished_path[PATH_MAX];
std::atomic<bool> is_unfinished{false};

class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) {
    const std::string stem =
        (target.parent_path() / (".vpm-" + std::to_string(::getpid()) + "-")).string();
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      path_ = stem + std::to_string(attempt) + ".tmp";
      if (path_.size() >= sizeof(unfinished_path)) cannot_write(target.string(), ENAMETOOLONG);
      // 0666: the umask says who may read the result.
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) cannot_write(target.string(), errno);
    }
    std::memcpy(unfinished_path, path_.c_str(), path_.size() + 1);
    is_unfinished = true;
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    remove_unfinished_output();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }

  void rename_to(const fs::path& target) {
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0) cannot_write(target.string(), errno);  // NFS reports here
    if (::rename(path_.c_str(), target.c_str()) != 0) cannot_write(target.string(), errno);
    is_unfinished = false;
  }

 private:
  std::string path_;
  int descriptor_ = -1;
};

// A link stays a link: what it points to is written, also where that is not there yet.
fs::path end_of_links(fs::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  std::error_code fault;
  for (int k = 0; fs::is_symlink(path, fault); ++k) {
    if (k == kMostLinks) cannot_write(path.string(), ELOOP);
    path = path.parent_path() / fs::read_symlink(path);
  }
  return path;
}

void write_file(const fs::path& target, std::span<const std::byte> bytes) {
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  TemporaryFile temporary(target);
  struct stat there {};
  if (::stat(target.c_str(), &there) == 0)  // who may read it stays as it was
    ::fchmod(temporary.descriptor(), there.st_mode & 07777);
  write_to(temporary.descriptor(), bytes, target.string());
  sync(temporary.descriptor(), target.string());
  temporary.rename_to(target);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (opened >= 0) sync(opened, target.string());
}

}  // namespace

std::vector<std::byte> read_all(const std::string& path) {
  const bool is_input = path == "-";
  const auto cannot_read = [&](const std::string& why) {
    refuse("cannot read " + (is_input ? std::string("standard input") : path) + ": " + why);
  };
  const Descriptor opened(is_input ? -1 : ::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!is_input && opened < 0) cannot_read(std::strerror(errno));
  const int descriptor = is_input ? STDIN_FILENO : static_cast<int>(opened);
  struct stat status {};
  if (::fstat(descriptor, &status) != 0) cannot_read(std::strerror(errno));
  if (S_ISDIR(status.st_mode)) cannot_read("it is a folder");

  // One byte more than the file has, so that its end is met without growing.
  constexpr std::size_t kFirstPipeBuffer = std::size_t{1} << 16;
  std::vector<std::byte> bytes(
      S_ISREG(status.st_mode) ? static_cast<std::size_t>(status.st_size) + 1 : kFirstPipeBuffer);
  std::size_t size = 0;
  for (;;) {
    if (size == bytes.size()) bytes.resize(2 * size);
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) cannot_read(std::strerror(errno));
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  bytes.resize(size);
  return bytes;
}

void write_all(const std::string& path, std::span<const std::byte> bytes) {
  if (path.empty()) cannot_write("the output", std::string("its name is empty"));
  if (path == "-" || path == "/dev/stdout") return write_to(STDOUT_FILENO, bytes, path);
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (fs::is_directory(status)) cannot_write(path, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    const Descriptor opened(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
    if (opened < 0) cannot_write(path, errno);
    return write_to(opened, bytes, path);
  }
  write_file(end_of_links(path), bytes);
}

void write_all(const std::string& path, std::string_view text) {
  write_all(path, std::as_bytes(std::span(text)));
}

void remove_unfinished_output() {
  if (is_unfinished.exchange(false)) ::unlink(unfinished_path);
}

}  // namespace vpm::file
