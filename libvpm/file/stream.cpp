#include "libvpm/file/stream.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstring>
#include <filesystem>
#include <optional>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

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

std::string cannot_write_text(const std::string& path, const std::string& why) {
  return "cannot write " + (path == "-" ? std::string("to standard output") : path) + ": " + why;
}
[[noreturn]] void cannot_write(const std::string& path, const std::string& why) {
  throw Error(ErrorKind::cannot_write, cannot_write_text(path, why));
}
[[noreturn]] void cannot_write(const std::string& path, int fault) {
  const std::string why = std::strerror(fault);
  if (fault == EPIPE) throw ClosedPipe(cannot_write_text(path, why));
  cannot_write(path, why);
}

void write_to(int descriptor, std::span<const std::byte> bytes, const std::string& path) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) cannot_write(path, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

bool is_changed(const struct stat& before, const struct stat& after) {
  return before.st_size != after.st_size || before.st_mtim.tv_sec != after.st_mtim.tv_sec ||
         before.st_mtim.tv_nsec != after.st_mtim.tv_nsec;
}

void sync(int descriptor, const std::string& path) {
  // Ignores EINVAL and ENOTSUP: some file systems cannot sync.
  if (::fsync(descriptor) != 0 && errno != EINVAL && errno != ENOTSUP) cannot_write(path, errno);
}

constexpr std::string_view kMark = ".vpm-", kEnd = ".tmp";

// Returns the process in a temporary file's name; empty for other names.
std::optional<pid_t> process_in(const std::string& name) {
  if (!name.starts_with('.') || !name.ends_with(kEnd)) return std::nullopt;
  const std::size_t mark = name.rfind(kMark), dash = name.find('-', mark + kMark.size());
  if (mark == name.npos || dash == name.npos) return std::nullopt;
  const std::string_view text =
      std::string_view(name).substr(mark + kMark.size(), dash - mark - kMark.size());
  const std::optional<std::uint64_t> process = to_count(text);
  constexpr std::uint64_t kLargest = std::uint64_t{1} << 30;
  return process && *process > 0 && *process < kLargest
             ? std::optional(static_cast<pid_t>(*process))
             : std::nullopt;
}

void remove_unlocked(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) ::unlink(path.c_str());
  ::close(descriptor);
}

// Returns ".NAME.vpm-PID-NUMBER.tmp", which says which output of which process it is. NAME is the
// target's, cut if it is long.
std::string temporary_name(const std::string& target, int number) {
  constexpr std::size_t kLongest = 200;  // bytes; file systems allow 255 for the whole name
  return "." + target.substr(0, kLongest) + std::string(kMark) + std::to_string(::getpid()) + "-" +
         std::to_string(number) + std::string(kEnd);
}

// Removes the temporary files in a folder whose processes were killed: no process has the number,
// and none holds the file's lock. Ignores what it cannot read or remove.
void remove_leftovers(const std::string& folder) {
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const std::optional<pid_t> process = process_in(entry->path().filename().string());
    if (process && ::kill(*process, 0) != 0 && errno == ESRCH) remove_unlocked(entry->path());
  }
}

// Temporary files that exist now. Paths are plain arrays, since a signal handler reads them.
struct UnfinishedFile {
  char path[PATH_MAX];
  std::atomic<bool> is_taken{false}, is_there{false};

  void remove() {
    if (is_there.exchange(false)) ::unlink(path);
  }
};
UnfinishedFile unfinished_files[64];

class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : place_(target.string()) { open(target); }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }

  void rename_to(const fs::path& target) {
    const int descriptor = std::exchange(descriptor_, -1);
    if (::close(descriptor) != 0)
      cannot_write(target.string(), errno);  // NFS reports write errors here
    if (::rename(place_.file.path, target.c_str()) != 0) cannot_write(target.string(), errno);
    place_.file.is_there = false;
  }

 private:
  // Owns one slot of unfinished_files; at the end it removes the file if it still exists.
  struct Place {
    explicit Place(const std::string& target) : file(take(target)) {}
    ~Place() {
      file.remove();
      file.is_taken = false;
    }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    static UnfinishedFile& take(const std::string& target) {
      for (UnfinishedFile& file : unfinished_files)
        if (!file.is_taken.exchange(true)) return file;
      cannot_write(target, "too many outputs are under way");
    }
    UnfinishedFile& file;
  };

  void open(const fs::path& target) {
    const fs::path folder = target.parent_path();
    remove_leftovers(folder.empty() ? "." : folder.string());
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      const std::string path =
          (folder / temporary_name(target.filename().string(), attempt)).string();
      if (path.size() >= sizeof(place_.file.path)) cannot_write(target.string(), ENAMETOOLONG);
      std::memcpy(place_.file.path, path.c_str(), path.size() + 1);
      // Mode 0666 leaves the permissions to the umask.
      descriptor_ = ::open(place_.file.path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && errno != EEXIST) cannot_write(target.string(), errno);
    }
    place_.file.is_there = true;
    ::flock(descriptor_, LOCK_EX | LOCK_NB);  // tells others that this process lives
  }

  Place place_;
  int descriptor_ = -1;
};

// Follows symbolic links, so that the link stays and its target is written, even if that does not
// exist yet.
fs::path end_of_links(fs::path path) {
  constexpr int kMaxLinks = 40;  // the kernel's limit
  std::error_code fault;
  for (int k = 0; fs::is_symlink(path, fault); ++k) {
    if (k == kMaxLinks) cannot_write(path.string(), ELOOP);
    path = path.parent_path() / fs::read_symlink(path);
  }
  return path;
}

}  // namespace

class Output::Target {
 public:
  Target() = default;
  virtual ~Target() = default;
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  virtual void append(std::span<const std::byte> bytes) = 0;
  virtual void finish() {}
};

namespace {

// Writes to a descriptor of this process at its current position. Reopening it by path would
// overwrite a file behind it from the start.
class Straight : public Output::Target {
 public:
  explicit Straight(const std::string& path)
      : path_(path),
        own_(descriptor_of(path)),
        opened_(own_ ? -1 : ::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {
    if (!own_ && opened_ < 0) cannot_write(path, errno);
  }
  void append(std::span<const std::byte> bytes) override {
    write_to(own_.value_or(opened_), bytes, path_);
  }

 private:
  std::string path_;
  std::optional<int> own_;
  Descriptor opened_;
};

class WholeFile : public Output::Target {
 public:
  explicit WholeFile(const fs::path& target) : target_(target), temporary_(target) {
    struct stat there {};
    if (::stat(target.c_str(), &there) == 0)  // keep the permissions of the file that is replaced
      ::fchmod(temporary_.descriptor(), there.st_mode & 07777);
  }
  void append(std::span<const std::byte> bytes) override {
    constexpr std::size_t kBlock = std::size_t{1} << 16;
    if (waiting_.size() + bytes.size() > kBlock) write_waiting();
    if (bytes.size() > kBlock)
      write_to(temporary_.descriptor(), bytes, target_.string());
    else
      waiting_.insert(waiting_.end(), bytes.begin(), bytes.end());
  }
  void finish() override {
    write_waiting();
    sync(temporary_.descriptor(), target_.string());
    temporary_.rename_to(target_);
    const fs::path folder = target_.has_parent_path() ? target_.parent_path() : fs::path(".");
    const Descriptor opened(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (opened >= 0) sync(opened, target_.string());
  }

 private:
  void write_waiting() {
    write_to(temporary_.descriptor(), waiting_, target_.string());
    waiting_.clear();
  }

  fs::path target_;
  TemporaryFile temporary_;
  std::vector<std::byte> waiting_;
};

std::unique_ptr<Output::Target> open_target(const std::string& path) {
  if (path.empty()) cannot_write("the output", std::string("its name is empty"));
  if (descriptor_of(path)) return std::make_unique<Straight>(path);
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  if (fs::is_directory(status)) cannot_write(path, EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) return std::make_unique<Straight>(path);
  return std::make_unique<WholeFile>(end_of_links(path));
}

}  // namespace

std::optional<int> descriptor_of(std::string_view path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    const std::string_view number = path.substr(folder.size());
    int descriptor = 0;
    const auto [end, fault] =
        std::from_chars(number.data(), number.data() + number.size(), descriptor);
    if (fault == std::errc() && end == number.data() + number.size()) return descriptor;
  }
  return std::nullopt;
}

std::vector<std::byte> read_all(const std::string& path, std::size_t most_of_a_pipe) {
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
  const auto is_file = S_ISREG(status.st_mode);
  const std::size_t told = is_file ? static_cast<std::size_t>(status.st_size) : 0;
  const std::size_t most = std::max(told, most_of_a_pipe);

  // Reads one byte more than the file holds, so that its end is met without growing the buffer.
  constexpr std::size_t kFirstPipeBuffer = std::size_t{1} << 16;
  std::vector<std::byte> bytes(is_file ? told + 1 : kFirstPipeBuffer);
  std::size_t size = 0;
  for (;;) {
    if (size > most) {
      cannot_read("it goes on after " + std::to_string(most) +
                  " bytes, the most that is read of a pipe or device; give a file instead");
    }
    if (size == bytes.size()) bytes.resize(std::min(2 * size, most + 1));
    const ssize_t count = ::read(descriptor, bytes.data() + size, bytes.size() - size);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) cannot_read(std::strerror(errno));
    if (count == 0) break;
    size += static_cast<std::size_t>(count);
  }
  struct stat after {};
  if (is_file && ::fstat(descriptor, &after) == 0 && is_changed(status, after))
    cannot_read("it changed while it was read; try again when it is written");
  bytes.resize(size);
  return bytes;
}

Output::Output(const std::string& path) : target_(open_target(path)) {}
Output::~Output() = default;
void Output::append(std::span<const std::byte> bytes) {
  target_->append(bytes);
}
void Output::append(std::string_view text) {
  append(std::as_bytes(std::span(text)));
}
void Output::finish() {
  target_->finish();
}

void write_all(const std::string& path, std::span<const std::byte> bytes) {
  Output output(path);
  output.append(bytes);
  output.finish();
}
void write_all(const std::string& path, std::string_view text) {
  write_all(path, std::as_bytes(std::span(text)));
}

void remove_unfinished_output() {
  for (UnfinishedFile& file : unfinished_files) file.remove();
}

}  // namespace vpm::file
