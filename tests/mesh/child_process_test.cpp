// Work in a child process: its result, its crash, and its limits.
#include "libvpm/mesh/child_process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <ctime>
#include <new>
#include <string>

namespace vpm::test {
namespace {

constexpr ChildLimits kLimits{100'000'000, 5};
#if defined __SANITIZE_ADDRESS__ || defined __SANITIZE_THREAD__
constexpr bool kKeepsItsLimits = false;  // without memory, a sanitizer ends the program
#else
constexpr bool kKeepsItsLimits = true;
#endif

TEST(ChildProcess, ReturnsWhatItsWorkDoes) {
  const std::string large(1 << 20, 'x');  // more than a pipe holds
  EXPECT_EQ(run_in_child([&] { return large; }, kLimits).bytes, large);
  const ChildResult empty = run_in_child([] { return std::string(); }, kLimits);
  EXPECT_EQ(empty.end, ChildResult::End::returned);
  EXPECT_EQ(empty.bytes, "");
}

TEST(ChildProcess, ACrashIsSeen) {
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGKILL}) {
    const auto crash = [&] {
      std::raise(signal);
      return std::string("done");
    };
    EXPECT_EQ(run_in_child(crash, kLimits).end, ChildResult::End::crashed) << signal;
  }
}

TEST(ChildProcess, HasLimitedMemoryAndTime) {
  const auto take_memory = [] {
    try {
      return std::string(300'000'000, 'x').substr(0, 1);
    } catch (const std::bad_alloc&) {
      return std::string("no memory");
    }
  };
  if (kKeepsItsLimits) {
    EXPECT_EQ(run_in_child(take_memory, kLimits).bytes, "no memory");
  }
  const auto take_time = []() -> std::string {
    for (;;) std::clock();
  };
  EXPECT_EQ(run_in_child(take_time, {kLimits.memory, 1}).end, ChildResult::End::out_of_time);
}

}  // namespace
}  // namespace vpm::test
