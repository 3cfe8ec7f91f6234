#include "tools/query/kept_lines.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vpm/error.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "tools/common/error_text.h"
#include "tools/common/program.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

[[noreturn]] void cannot_write(const std::string& path, int fault) {
  throw Error(ErrorKind::cannot_write, "cannot write " + path + ": " + std::strerror(fault));
}

// Returns the file that the name leads to, so that symbolic links stay.
std::string end_of_links(const std::string& path) {
  constexpr int kMostLinks = 40;  // the kernel's limit
  fs::path end = path;
  std::error_code fault;
  for (int k = 0; k < kMostLinks && fs::is_symlink(end, fault); ++k)
    end = end.parent_path() / fs::read_symlink(end);
  return end.string();
}

// Whole lines of a file: their number, and where the last one ends.
struct WholeLines {
  std::size_t count = 0;
  off_t end = 0;
};

// Counts the whole lines from the file's start. An end of a line within quotes is part of a field
// in CSV; JSON has none.
WholeLines whole_lines(int descriptor, bool is_csv) {
  WholeLines lines;
  std::array<char, std::size_t{1} << 16> block{};
  bool is_quoted = false;
  off_t place = 0;
  for (ssize_t size = 0; (size = ::pread(descriptor, block.data(), block.size(), place)) > 0;) {
    for (ssize_t k = 0; k < size; ++k) {
      const char letter = block[static_cast<std::size_t>(k)];
      if (is_csv && letter == '"') is_quoted = !is_quoted;
      if (letter == '\n' && !is_quoted) lines = {lines.count + 1, place + k + 1};
    }
    place += size;
  }
  return lines;
}

Json told_in(const std::string& path) {
  std::error_code fault;
  if (!fs::exists(path, fault)) return Json::object();
  const std::vector<std::byte> bytes = file::read_all(path);
  Json told = Json::parse(bytes, nullptr, false);
  return told.is_object() ? told : Json::object();
}

// Returns the file that holds the lines of an output until they are done.
std::string part_of(const std::string& path) {
  return end_of_links(path) + ".part";
}

}  // namespace

bool KeptLines::are_kept(const std::string& path) {
  std::error_code fault;
  const fs::file_status status = fs::status(path, fault);
  return !file::descriptor_of(path) && (!fs::exists(status) || fs::is_regular_file(status));
}

std::vector<std::string> KeptLines::beside(const std::string& path) {
  if (path.empty() || !are_kept(path)) return {};
  const std::string part = part_of(path);
  return {part, part + ".json"};
}

void KeptLines::check(const std::string& path, Leftover leftover) {
  const std::string part = part_of(path);
  std::error_code fault;
  if (leftover != Leftover::refuse || !are_kept(path) || !fs::exists(part, fault)) return;
  refuse_usage(part + " holds lines of a run that was interrupted: give --resume to go on after " +
               "them, or --force to begin anew");
}

bool KeptLines::are_finished(const std::string& path, Leftover leftover) {
  std::error_code fault;
  return leftover == Leftover::resume && !file::descriptor_of(path) &&
         fs::is_regular_file(path, fault) && !fs::exists(part_of(path), fault);
}

KeptLines::KeptLines(const std::string& path, const Json& run, Leftover leftover)
    : target_(end_of_links(path)), part_(part_of(path)), told_(part_ + ".json") {
  open();
  try {
    if (leftover == Leftover::resume) go_on(run);
    if (lines_ > 0) return;
    file::write_all(told_, run.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
    if (::ftruncate(descriptor_, 0) != 0) cannot_write(part_, errno);
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

KeptLines::~KeptLines() {
  if (is_finished_) return;
  if (lines_ == 0) {
    ::unlink(part_.c_str());
    ::unlink(told_.c_str());
  }
  ::close(descriptor_);
}

void KeptLines::open() {
  // Mode 0666 leaves the permissions to the umask.
  descriptor_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor_ < 0) cannot_write(target_, errno);
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw Error(ErrorKind::cannot_write, "another run writes " + part_ + " now", {},
                "wait for its end, or name another output");
  }
  struct stat there {};
  if (::stat(target_.c_str(), &there) == 0)  // keep the permissions of the file that is replaced
    ::fchmod(descriptor_, there.st_mode & 07777);
}

// Keeps the whole lines that are there, if they are of the same run.
void KeptLines::go_on(const Json& run) {
  const WholeLines whole = whole_lines(descriptor_, is_csv(target_));
  if (whole.count == 0) return;
  const std::string names = differences(told_in(told_), run);
  if (!names.empty())
    throw Error(ErrorKind::invalid_argument, part_ + ": its lines are of a run with other " + names,
                {}, "give the same options and files, or --force without --resume to begin anew");
  if (::ftruncate(descriptor_, whole.end) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0)
    cannot_write(part_, errno);
  lines_ = whole.count;
}

void KeptLines::append(std::string_view text, std::size_t lines) {
  while (!text.empty()) {
    const ssize_t size = ::write(descriptor_, text.data(), text.size());
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) {
      const int fault = errno;
      lines_ = whole_lines(descriptor_, is_csv(target_)).count;  // some of these may be there
      cannot_write(target_, fault);
    }
    text.remove_prefix(static_cast<std::size_t>(size));
  }
  lines_ += lines;
}

bool is_csv(const std::string& path) {
  return file::in_lower_case(fs::path(path).extension().string()) == ".csv";
}

void KeptLines::finish() {
  // Ignores EINVAL and ENOTSUP: some file systems cannot sync.
  if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != ENOTSUP)
    cannot_write(target_, errno);
  if (::rename(part_.c_str(), target_.c_str()) != 0) cannot_write(target_, errno);
  is_finished_ = true;
  ::unlink(told_.c_str());
  if (::close(descriptor_) != 0) cannot_write(target_, errno);  // NFS reports write errors here
}

}  // namespace vpm::tools
