#include "tests/fuzz/fuzz_worker.h"

#include <sanitizer/common_interface_defs.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include "libvpm/mesh/child_process.h"

// libFuzzer's counters of covered edges.
extern "C" {
[[gnu::visibility("hidden")]] extern std::byte __start___sancov_cntrs[];
[[gnu::visibility("hidden")]] extern std::byte __stop___sancov_cntrs[];
}

namespace vpm {

// Takes the place of the library's in this program: the worker is the child already.
ChildResult run_in_child(const std::function<std::string()>& work, const ChildLimits&) {
  return {ChildResult::End::returned, work()};
}

}  // namespace vpm

namespace vpm::fuzz {
namespace {

constexpr std::size_t kMostBytes = 1 << 20;  // longest input
constexpr std::size_t kMostRuns = 10'000;    // inputs of one worker, as assimp may leak

std::byte* shared_memory(std::size_t size) {
  void* memory = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) fail("no shared memory");
  return static_cast<std::byte*>(memory);
}

// Shares the counters with processes that are forked later, all but those on the first and last
// page, which others use too.
void share_counters() {
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = (reinterpret_cast<std::size_t>(__start___sancov_cntrs) + page - 1) / page;
  const auto end = reinterpret_cast<std::size_t>(__stop___sancov_cntrs) / page;
  if (begin >= end) return;
  const std::size_t size = (end - begin) * page;
  auto* const place = reinterpret_cast<std::byte*>(begin * page);
  std::byte* const shared = shared_memory(size);
  std::copy_n(place, size, shared);
  if (::mremap(shared, size, size, MREMAP_MAYMOVE | MREMAP_FIXED, place) == MAP_FAILED)
    fail("the counters cannot be shared");
}

void end_by_signal(int) {
  __sanitizer_print_stack_trace();
  ::_exit(EXIT_FAILURE);
}

// Lets ends of the worker tell the whole stack, and not be written as findings by libFuzzer, whose
// handlers fork() has copied.
void handle_ends() {
  __sanitizer_set_death_callback([] { __sanitizer_print_stack_trace(); });
  for (const int signal : {SIGPROF, SIGABRT}) std::signal(signal, end_by_signal);
}

// Runs the inputs whose sizes the requests tell.
[[noreturn]] void serve(const Target& target, const std::byte* input, int requests, int answers) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  handle_ends();
  std::size_t size = 0;
  while (::read(requests, &size, sizeof size) == sizeof size) {
    const itimerval limit = {{}, {kMostSeconds, 0}}, none = {};
    ::setitimer(ITIMER_PROF, &limit, nullptr);
    target.run({input, size});
    ::setitimer(ITIMER_PROF, &none, nullptr);
    if (::write(answers, "", 1) != 1) break;
  }
  ::_exit(EXIT_SUCCESS);
}

}  // namespace

Worker::Worker(const Target& target)
    : target_(target), input_(shared_memory(kMostBytes)), said_(::memfd_create("said", 0)) {
  share_counters();
  std::signal(SIGPIPE, SIG_IGN);
}

void Worker::start() {
  std::array<int, 2> requests{}, answers{};
  if (::pipe(requests.data()) != 0 || ::pipe(answers.data()) != 0) fail("no pipe");
  process_ = ::fork();
  if (process_ < 0) fail("no process");
  if (process_ == 0) {
    ::close(requests[1]);
    ::close(answers[0]);
    ::dup2(said_, STDERR_FILENO);
    serve(target_, input_, requests[0], answers[1]);
  }
  ::close(requests[0]);
  ::close(answers[1]);
  requests_ = requests[1];
  answers_ = answers[0];
  runs_ = 0;
}

void Worker::stop() {
  ::close(requests_);
  ::close(answers_);
  ::waitpid(process_, nullptr, 0);
  process_ = 0;
}

// Returns what the worker has said since this was last asked.
std::string Worker::last_words() const {
  std::string text(static_cast<std::size_t>(::lseek(said_, 0, SEEK_END)), '\0');
  if (::pread(said_, text.data(), text.size(), 0) < 0 || ::ftruncate(said_, 0) != 0 ||
      ::lseek(said_, 0, SEEK_SET) != 0)
    fail("the worker's words are lost");
  return text;
}

// Runs the input; false if that ends the worker.
bool Worker::survives(Bytes input) {
  if (process_ != 0 && runs_ == kMostRuns) stop();
  if (process_ == 0) start();
  ++runs_;
  std::copy(input.begin(), input.end(), input_);
  const std::size_t size = input.size();
  char answer = 0;
  if (::write(requests_, &size, sizeof size) == sizeof size && ::read(answers_, &answer, 1) == 1)
    return true;
  stop();
  return false;
}

void Worker::run(Bytes input) {
  if (input.size() > kMostBytes) return;
  // Asks a second worker, which has read nothing before: memory that assimp spoiled may end the
  // first one at a later input.
  for (int chance = 0; chance < 2; ++chance) {
    if (survives(input)) return;
    const std::string words = last_words();
    if (words.find("libassimp") != words.npos) return;
    std::fputs(words.c_str(), stderr);
  }
  fail("the input ends the process that reads it");
}

}  // namespace vpm::fuzz
