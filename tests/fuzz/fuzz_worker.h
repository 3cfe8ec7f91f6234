// Process that runs a target whose library crashes on some files.
#pragma once

#include <sys/types.h>

#include <string>

#include "tests/fuzz/fuzz_target.h"

namespace vpm::fuzz {

// Runs inputs one after the other in a process of its own, which lives until an input ends it. That
// is a finding only if no function of assimp is on the stack: the reader of scenes has such ends in
// a child process (libvpm/mesh/child_process.h), which takes five times as long and is not made
// here. What the process covers counts as if it were this one's.
class Worker {
 public:
  explicit Worker(const Target& target);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Ends this process by SIGABRT, after what the worker has said, if the input ends also a new
  // worker, and not within assimp.
  void run(Bytes input);

 private:
  void start();
  void stop();
  bool survives(Bytes input);
  std::string last_words() const;

  const Target& target_;
  std::byte* input_;  // shared with the worker
  pid_t process_ = 0;
  int requests_ = -1, answers_ = -1;  // pipes to the worker and from it
  int said_;                          // file in memory of what the worker has said
  std::size_t runs_ = 0;
};

}  // namespace vpm::fuzz
