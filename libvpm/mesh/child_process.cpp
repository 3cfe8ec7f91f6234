#include "libvpm/mesh/child_process.h"

#include <fcntl.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

constexpr char kComplete = '.';  // last byte that a child sends

bool write_all(int pipe, const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size();) {
    const ssize_t count = ::write(pipe, bytes.data() + at, bytes.size() - at);
    if (count < 0 && errno != EINTR) return false;
    at += count > 0 ? static_cast<std::size_t>(count) : 0;
  }
  return true;
}

std::string read_to_end(int pipe) {
  std::string bytes;
  std::vector<char> part(1 << 16);
  for (;;) {
    const ssize_t count = ::read(pipe, part.data(), part.size());
    if (count > 0) bytes.append(part.data(), static_cast<std::size_t>(count));
    if (count == 0 || (count < 0 && errno != EINTR)) return bytes;
  }
}

void set_limit(int resource, rlim_t most) {
  rlimit limit{};
  if (::getrlimit(resource, &limit) != 0) return;
  limit.rlim_cur = std::min(limit.rlim_cur, most);
  ::setrlimit(resource, &limit);
}

void apply(const ChildLimits& limits) {
  set_limit(RLIMIT_CORE, 0);
  set_limit(RLIMIT_CPU, limits.seconds);
#ifdef __linux__
  std::uint64_t pages = 0;  // all that the process has mapped
  std::ifstream("/proc/self/statm") >> pages;
  if (pages == 0) return;
  set_limit(RLIMIT_AS, pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + limits.memory);
#endif
}

// Ends the child without running what belongs to the parent: its destructors, and handlers of
// signals, which remove the parent's unfinished files.
[[noreturn]] void be_child(int pipe, const std::function<std::string()>& work,
                           const ChildLimits& limits) {
  for (const int signal :
       {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU, SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, SIG_DFL);
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
#endif
  apply(limits);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
  ::_exit(write_all(pipe, work() + kComplete) ? EXIT_SUCCESS : EXIT_FAILURE);
}

[[noreturn]] void refuse_child() {
  refuse(std::string("no process can be made to read this format in: ") + std::strerror(errno));
}

}  // namespace

ChildResult run_in_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) refuse_child();
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    be_child(ends[1], work, limits);
  }
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    refuse_child();
  }
  std::string bytes;
  try {
    bytes = read_to_end(ends[0]);
  } catch (...) {  // no memory: the child ends as its pipe does
    ::close(ends[0]);
    ::waitpid(child, nullptr, 0);
    throw;
  }
  ::close(ends[0]);
  int status = 0;  // stays so where the program ignores the ends of its children
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  const bool is_good = WIFEXITED(status) && WEXITSTATUS(status) == EXIT_SUCCESS;
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)
    return {ChildResult::End::out_of_time, {}};
  if (!is_good || !bytes.ends_with(kComplete)) return {ChildResult::End::crashed, {}};
  bytes.pop_back();
  return {ChildResult::End::returned, std::move(bytes)};
}

}  // namespace vpm
