// Processes that run a program for one entry of a list after the other. What takes long to begin,
// such as the use of a GPU, begins once in each.
#pragma once

#include <sys/types.h>
#include <sys/wait.h>

#include <string>
#include <vector>

namespace vpm::tools {

// Variable of the environment that names the GPUs which a process sees.
inline constexpr const char* kVisibleGpus = "CUDA_VISIBLE_DEVICES";

// How a run of the program ended, and the lines that it said.
struct Ended {
  int status = 0;  // as waitpid() tells it of a process of one run
  std::vector<std::string> said;

  // True if the run did its job: exit codes from 10 on are answers to a script's question.
  bool is_done() const {
    return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) >= 10);
  }
  bool is_refused_usage() const { return WIFEXITED(status) && WEXITSTATUS(status) == 2; }
  // Returns the last error that the run said, or how else it ended.
  std::string fault() const;
};

// A process that has one run at a time. It does not outlive this one.
class Worker {
 public:
  // Starts it, on a GPU by its name in CUDA_VISIBLE_DEVICES; "": with all. Throws Error(refused).
  explicit Worker(const std::string& gpu);
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  // Ends the process, amidst a run too, and waits for its end.
  ~Worker();

  // Begins a run, with the text of a configuration. Throws Error(refused).
  void begin(const std::string& configuration);
  // Becomes readable when the run ends, or the process with it.
  int socket() const { return socket_.number; }
  // Waits until the run ends, and returns how. A worker whose run failed must begin no other one:
  // what two runs share in a process, such as the use of a GPU, may be broken.
  Ended end();
  // Lets the process end, for which the destructor waits.
  void dismiss() const;

 private:
  struct Descriptor {
    int number = -1;
    ~Descriptor();
  };
  [[noreturn]] void become(char* const* words, char* const* environment, int socket,
                           pid_t parent) const;

  Descriptor configuration_, said_;  // files in memory
  Descriptor socket_;                // takes a byte to begin a run, gives the exit code of each
  pid_t process_ = -1;               // -1 after its end
};

// Runs a program, which is what main() does: for the command line, or, in a process that Worker
// started, for each configuration. Returns the process's exit status.
int run_or_work(int argc, char** argv, int (*program)(int argc, char** argv));

}  // namespace vpm::tools
