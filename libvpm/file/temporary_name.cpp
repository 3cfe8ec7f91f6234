#include "libvpm/file/temporary_name.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <optional>

#include "libvpm/file/text.h"

namespace vpm::file {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

std::string temporary_name(const std::string& target, int number) {
  constexpr std::size_t kLongest = 200;  // of the 255 bytes that file systems allow
  return "." + target.substr(0, kLongest) + std::string(kMark) + std::to_string(::getpid()) + "-" +
         std::to_string(number) + std::string(kEnd);
}

void remove_leftovers(const std::string& folder) {
  std::error_code fault;
  for (fs::directory_iterator entry(folder, fault), end; !fault && entry != end;
       entry.increment(fault)) {
    const std::optional<pid_t> process = process_in(entry->path().filename().string());
    if (process && ::kill(*process, 0) != 0 && errno == ESRCH) remove_unlocked(entry->path());
  }
}

}  // namespace vpm::file
