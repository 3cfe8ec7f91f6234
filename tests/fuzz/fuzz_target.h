// Targets of the fuzzer: each feeds bytes to one reader, and what is accepted to what uses it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "libvpm/core/pose.h"

namespace vpm::fuzz {

using Bytes = std::span<const std::byte>;

struct Target {
  const char* name;  // names its folders of seeds and findings too
  void (*run)(Bytes input);
  // Changes `size` bytes, at most to `most`, and returns the new size; null: bytes are changed
  // blindly.
  std::size_t (*mutate)(std::uint8_t* data, std::size_t size, std::size_t most,
                        unsigned seed) = nullptr;
  bool may_crash = false;  // true if a library that it uses crashes on some inputs
};

// Returns the target of this name, or null.
const Target* find_target(std::string_view name);
std::span<const Target> all_targets();

// Most seconds of the processor that an input may take: other work of the machine does not count.
inline constexpr int kMostSeconds = 5;

// Runs a target on an input, which may take kMostSeconds.
void run_in_time(const Target& target, Bytes input);

// Ends the process by SIGABRT: a promise is broken.
[[noreturn]] void fail(const std::string& promise);

// Runs a reader. It may throw Error only, with a message that is not empty, of one line of
// printable characters, and of 1500 bytes at most.
void expect_error_at_most(const std::function<void()>& reader);

void expect_finite(const Pose& pose);

// Returns the path of a file in memory that has these bytes until the next call.
const std::string& path_of(Bytes bytes);

inline std::string text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Decides by the bytes of an input alone what is done with it where doing everything would be slow.
class Choice {
 public:
  explicit Choice(Bytes input) : rest_(std::hash<std::string>()(text_of(input))) {}

  // Returns a number less than `ways`, each about as often; calls do not depend on each other.
  std::size_t one_of(std::size_t ways) {
    const std::size_t chosen = rest_ % ways;
    rest_ /= ways;
    return chosen;
  }

 private:
  std::size_t rest_;
};

}  // namespace vpm::fuzz
