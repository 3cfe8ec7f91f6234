#include "tools/common/list_run.h"

#include <poll.h>
#include <vpm/device.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <memory>
#include <sstream>
#include <string_view>

#include "libvpm/core/error.h"
#include "tools/common/error_text.h"
#include "tools/common/list_record.h"
#include "tools/common/list_worker.h"
#include "tools/common/number_checks.h"

namespace vpm::tools {
namespace {

// Returns the GPUs that runs are spread over, as CUDA_VISIBLE_DEVICES names them: none where there
// is none, or where --device says more than that a GPU is wanted.
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
  if (gpus.size() == 1 && cuda_device_count() == 0) gpus.clear();
  return gpus;
}

class ListRun {
 public:
  ListRun(const Program& program, const ListArguments& a, std::vector<ListEntry> entries)
      : program_(program),
        entries_(std::move(entries)),
        faults_(entries_.size()),
        progress_("inputs", program.common()) {
    const int threads = thread_count();
    const std::vector<std::string> gpus = gpus_for(program);
    // Runs on the same GPU wait for each other.
    const int at_once = gpus.empty() ? threads : static_cast<int>(gpus.size());
    const int jobs = a.jobs > 0 ? a.jobs : at_once;
    threads_ = std::max(1, threads / jobs);
    for (std::size_t k = 0; k < static_cast<std::size_t>(jobs); ++k)
      jobs_.push_back({gpus.empty() ? "" : gpus[k % gpus.size()]});
    for (const ListEntry& entry : entries_) records_.emplace_back(program, entry);
  }

  void run() {
    for (std::size_t k = 0; k < entries_.size(); ++k) trying(k, [&] { take(k); });
    while (std::ranges::any_of(jobs_, &Job::is_at_work)) wait_for_some();
    for (const Job& job : jobs_)
      if (job.worker) job.worker->dismiss();
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
  // One of the runs at a time.
  struct Job {
    std::string gpu;
    std::unique_ptr<Worker> worker{};  // none before its first run, and after one that failed
    std::size_t entry = 0;             // of its run
    Outputs before = Outputs::none;
    bool is_at_work = false;
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

  // Passes over what is done, or lets a worker begin with it once there is one.
  void take(std::size_t k) {
    const bool is_forced = program_.common().force;
    const Outputs before = is_forced ? Outputs::stale : records_[k].state(hashes_);
    if (before == Outputs::valid) {
      ++there_;
      return done(k);
    }
    if (before == Outputs::stale && !is_forced)
      program_.detail(entries_[k].input + " is made anew: it, another input or an output changed");
    Job& job = free_job();
    records_[k].begin(hashes_);
    nlohmann::json options = entries_[k].options;
    options["threads"] = threads_;
    options["force"] = before != Outputs::none;
    if (!job.worker) job.worker = std::make_unique<Worker>(job.gpu);
    job.worker->begin(options.dump());
    job.entry = k;
    job.before = before;
    job.is_at_work = true;
  }

  Job& free_job() {
    for (;; wait_for_some()) {
      const auto job = std::ranges::find(jobs_, false, &Job::is_at_work);
      if (job != jobs_.end()) return *job;
    }
  }

  // Waits until a run ends, and takes those that have.
  void wait_for_some() {
    std::vector<pollfd> sockets;
    for (const Job& job : jobs_)  // poll() passes over -1
      sockets.push_back({job.is_at_work ? job.worker->socket() : -1, POLLIN, 0});
    while (::poll(sockets.data(), sockets.size(), -1) < 0 && errno == EINTR) {
    }
    for (std::size_t k = 0; k < jobs_.size(); ++k)
      if (sockets[k].revents != 0) trying(jobs_[k].entry, [&] { finish(jobs_[k]); });
  }

  void finish(Job& job) {
    const std::size_t k = job.entry;
    const Ended ended = job.worker->end();
    job.is_at_work = false;
    if (!ended.is_done()) {
      job.worker.reset();
      if (job.before == Outputs::none && ended.is_refused_usage()) records_[k].forget();
      return end(k, ended.fault());
    }
    records_[k].finish(WEXITSTATUS(ended.status), ended.said);
    ++(job.before == Outputs::stale ? anew_ : made_);
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
  std::vector<Job> jobs_;
  Progress progress_;
  Hashes hashes_;
  std::size_t there_ = 0, made_ = 0, anew_ = 0, warned_ = 0, ended_ = 0;
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
  app.add_option("--jobs", a.jobs,
                 "Inputs of --list that are worked on at a time; 0: one per core, or per GPU where "
                 "these are used")
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
