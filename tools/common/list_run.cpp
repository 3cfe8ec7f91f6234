#include "tools/common/list_run.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>
#include <vpm/device.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <map>
#include <sstream>
#include <string_view>

#include "libvpm/core/error.h"
#include "tools/common/error_text.h"
#include "tools/common/list_record.h"
#include "tools/common/number_checks.h"

namespace vpm::tools {
namespace {

constexpr const char* kVisibleGpus = "CUDA_VISIBLE_DEVICES";
constexpr int kFirstAnswer = 10;  // exit codes from here on are answers of a run that did its job

// How a run of the program ended, and the lines that it said.
struct Ended {
  int status = 0;  // as waitpid() tells it
  std::vector<std::string> said;

  bool is_done() const {
    return WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) >= kFirstAnswer);
  }
  bool is_refused_usage() const { return WIFEXITED(status) && WEXITSTATUS(status) == 2; }
};

// Returns a file in memory.
int memory_file(const char* name, unsigned flags) {
  const int file = ::memfd_create(name, flags);
  if (file < 0) refuse(std::string("no process can be started: ") + std::strerror(errno));
  return file;
}

// A process of the program.
class Run {
 public:
  // Starts it with options, and on a GPU by its name in CUDA_VISIBLE_DEVICES; "": with all.
  Run(const std::string& configuration, const std::string& gpu)
      : said_(memory_file("said", MFD_CLOEXEC)) {
    const int options = memory_file("options", 0);
    if (::write(options, configuration.data(), configuration.size()) !=
        static_cast<ssize_t>(configuration.size()))
      refuse(std::string("no process can be started: ") + std::strerror(errno));
    const std::string path = "/proc/self/fd/" + std::to_string(options);
    std::string visible = kVisibleGpus + ("=" + gpu);
    std::vector<char*> environment;
    for (char** one = environ; *one != nullptr; ++one)
      if (gpu.empty() || !std::string_view(*one).starts_with(kVisibleGpus + std::string("=")))
        environment.push_back(*one);
    if (!gpu.empty()) environment.push_back(visible.data());
    environment.push_back(nullptr);
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ == 0) become(path.c_str(), parent, environment.data());
    ::close(options);
    if (process_ < 0) refuse(std::string("no process can be started: ") + std::strerror(errno));
  }

  pid_t process() const { return process_; }

  Ended end(int status) const {
    Ended ended{status, {}};
    std::FILE* const file = ::fdopen(said_, "r");
    std::rewind(file);
    char* line = nullptr;
    std::size_t room = 0;
    for (ssize_t size = 0; (size = ::getline(&line, &room, file)) > 0;)
      ended.said.emplace_back(line, static_cast<std::size_t>(size - (line[size - 1] == '\n')));
    std::free(line);
    std::fclose(file);
    return ended;
  }

 private:
  // Calls only what a process may call after fork() that had other threads.
  [[noreturn]] void become(const char* options, pid_t parent, char** environment) const {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // the run does not outlive the list's
    if (::getppid() != parent) ::_exit(1);
    const int nothing = ::open("/dev/null", O_RDWR);
    ::dup2(nothing, STDIN_FILENO);
    ::dup2(nothing, STDOUT_FILENO);
    ::dup2(said_, STDERR_FILENO);
    ::execle("/proc/self/exe", program_invocation_name, "--config", options, nullptr, environment);
    ::_exit(127);
  }

  int said_;
  pid_t process_ = -1;
};

// Returns the GPUs that runs are spread over, as CUDA_VISIBLE_DEVICES names them: none where there
// is one at most, or where --device says more than that a GPU is wanted.
std::vector<std::string> gpus_for(const Program& program) {
  const std::string& device = program.common().device;
  if (!program.can_use_devices() || (device != "auto" && device != "cuda")) return {};
  std::vector<std::string> gpus;
  if (const char* const visible = std::getenv(kVisibleGpus)) {
    std::istringstream names(visible);
    for (std::string name; std::getline(names, name, ',');) gpus.push_back(name);
  } else {
    for (int k = 0; k < cuda_device_count(); ++k) gpus.push_back(std::to_string(k));
  }
  if (gpus.size() < 2) gpus.clear();
  return gpus;
}

// Returns the last error that a run said, or how else it ended.
std::string fault_of(const Ended& ended) {
  if (WIFSIGNALED(ended.status))
    return std::string("its process was ended by a signal: ") + ::strsignal(WTERMSIG(ended.status));
  constexpr std::string_view kError = ": error: ";
  for (auto line = ended.said.rbegin(); line != ended.said.rend(); ++line)
    if (const std::size_t k = line->find(kError); k != line->npos)
      return line->substr(k + kError.size());
  return "its process ended with exit status " + std::to_string(WEXITSTATUS(ended.status));
}

class ListRun {
 public:
  ListRun(const Program& program, const ListArguments& a, std::vector<ListEntry> entries)
      : program_(program),
        entries_(std::move(entries)),
        faults_(entries_.size()),
        gpus_(gpus_for(program)),
        progress_("inputs", program.common()) {
    const int threads = thread_count();
    jobs_ = static_cast<std::size_t>(a.jobs > 0 ? a.jobs : threads);
    threads_ = std::max(1, threads / static_cast<int>(jobs_));
    for (const ListEntry& entry : entries_) records_.emplace_back(program, entry);
  }

  void run() {
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      if (runs_.size() == jobs_) wait_for_one();
      trying(k, [&] { start(k); });
    }
    while (!runs_.empty()) wait_for_one();
  }

  // Prints the table and the faults.
  void tell() const {
    for (std::size_t k = 0; k < entries_.size(); ++k)
      if (!faults_[k].empty()) program_.error(entries_[k].input + ": " + faults_[k]);
    if (warned_ > 0)
      program_.warn(std::to_string(warned_) + (warned_ == 1 ? " input has" : " inputs have") +
                    " warnings, such as: " + warning_);
    if (program_.common().quiet) return;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin_;
    char row[160];
    std::snprintf(row, sizeof row, "%8zu%8zu%8zu%8zu%8zu%10.1f%12.1f\n", entries_.size(), there_,
                  made_, anew_, failed(), taken.count(),
                  static_cast<double>(made_ + anew_) / taken.count());
    std::cout << "  inputs   there    made    anew  failed   seconds  per second\n" << row;
  }

  std::size_t failed() const {
    return entries_.size() - static_cast<std::size_t>(std::ranges::count(faults_, ""));
  }
  std::size_t size() const { return entries_.size(); }
  int answer() const { return answer_; }

 private:
  struct Started {
    Run run;
    std::size_t entry;
    Outputs before;
    std::string gpu;
  };

  // Keeps the fault of an entry, which harms no other.
  template <class Action>
  void trying(std::size_t k, const Action& action) {
    try {
      action();
    } catch (const Error& fault) {
      end(k, fault.what());
    }
  }

  void start(std::size_t k) {
    const bool is_forced = program_.common().force;
    const Outputs before = is_forced ? Outputs::stale : records_[k].state(hashes_);
    if (before == Outputs::valid) {
      ++there_;
      return done(k);
    }
    if (before == Outputs::stale && !is_forced)
      program_.detail(entries_[k].input + " is made anew: it, another input or an output changed");
    records_[k].begin(hashes_);
    nlohmann::json options = entries_[k].options;
    options["threads"] = threads_;
    options["force"] = before != Outputs::none;
    const std::string gpu = next_gpu();
    Run run(options.dump(), gpu);
    runs_.emplace(run.process(), Started{run, k, before, gpu});
  }

  // Returns the GPU that the fewest runs have; "" where there are not several.
  std::string next_gpu() const {
    const auto runs_on = [&](const std::string& gpu) {
      return std::ranges::count_if(runs_, [&](const auto& run) { return run.second.gpu == gpu; });
    };
    return gpus_.empty() ? "" : *std::ranges::min_element(gpus_, {}, runs_on);
  }

  void wait_for_one() {
    int status = 0;
    pid_t process = 0;
    do process = ::waitpid(-1, &status, 0);
    while (process < 0 && errno == EINTR);
    const auto place = runs_.find(process);
    if (place == runs_.end()) return;
    const Started started = place->second;
    runs_.erase(place);
    const Ended ended = started.run.end(status);
    trying(started.entry, [&] { finish(started, ended); });
  }

  void finish(const Started& started, const Ended& ended) {
    const std::size_t k = started.entry;
    if (!ended.is_done()) {
      if (started.before == Outputs::none && ended.is_refused_usage()) records_[k].forget();
      return end(k, fault_of(ended));
    }
    records_[k].finish(WEXITSTATUS(ended.status), ended.said);
    ++(started.before == Outputs::stale ? anew_ : made_);
    done(k);
  }

  // Counts what a run answered and said, now or long ago.
  void done(std::size_t k) {
    const int code = records_[k].exit_code();
    if (code != 0) answer_ = answer_ == 0 ? code : std::min(answer_, code);
    bool has_warning = false;
    for (const std::string& line : records_[k].said()) {
      program_.detail(entries_[k].input + ": " + line);
      const std::size_t at = line.find(": warning: ");
      if (at == line.npos) continue;
      has_warning = true;
      if (warning_.empty()) warning_ = line.substr(at + std::strlen(": warning: "));
    }
    warned_ += has_warning;
    end(k, "");
  }

  void end(std::size_t k, const std::string& fault) {
    faults_[k] = fault;
    progress_.update(static_cast<double>(++ended_) / static_cast<double>(entries_.size()));
  }

  const Program& program_;
  std::vector<ListEntry> entries_;
  std::vector<std::string> faults_;  // of each entry; empty for those that are done
  std::vector<ListRecord> records_;
  std::vector<std::string> gpus_;
  Progress progress_;
  Hashes hashes_;
  std::map<pid_t, Started> runs_;
  std::size_t jobs_ = 1, there_ = 0, made_ = 0, anew_ = 0, warned_ = 0, ended_ = 0;
  std::string warning_;
  int threads_ = 1, answer_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace

void declare_list(CLI::App& app, ListArguments& a) {
  begin_group(app, "Many inputs", Group::rare);
  app.add_option("--list", a.list,
                 "Instead of an input: a file that names one on each line. Each has an output of "
                 "its own in the folder --output; those that are done are passed over")
      ->option_text("FILE");
  app.add_option("--shard", a.shard, "Of --list, only part i of n: every n-th line from the i-th")
      ->option_text("I/N");
  app.add_option("--jobs", a.jobs, "Inputs of --list that are worked on at a time; 0: one per core")
      ->check(whole_number_in(0, 4096))
      ->capture_default_str();
}

bool run_list(Program& program, const ListArguments& a, const ListedInput& input) {
  if (a.list.empty() && a.shard.empty() && a.jobs == 0) return false;
  if (a.list.empty()) refuse_usage("--shard and --jobs go with --list, which names the inputs");
  ListRun list(program, a, read_list(program, a, input));
  list.run();
  list.tell();
  program.end_with(list.answer());
  if (list.failed() > 0)
    refuse(std::to_string(list.failed()) + " of " + std::to_string(list.size()) + " inputs of " +
           a.list + " failed; the same command tries them again");
  return true;
}

}  // namespace vpm::tools
