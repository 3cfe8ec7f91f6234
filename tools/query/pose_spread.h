// Answers poses by several threads, and hands the answers over in the order of the poses.
#pragma once

#include <vpm/query_types.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "tools/query/query_report.h"

namespace vpm::tools {

// A pose with its answer.
struct AnsweredPose {
  AskedPose asked;
  Result result;                     // unless only collisions are asked for
  std::optional<Collides> collides;  // if they are
  nlohmann::ordered_json line;       // of results
  double seconds = 0;                // that the answer took
};

class PoseSpread {
 public:
  // Answers the `index`-th pose that was added by the `thread`-th thread; called by all threads at
  // once.
  using Answer =
      std::function<AnsweredPose(std::size_t thread, std::size_t index, const AskedPose& asked)>;
  // Takes the answers in order, each as soon as it and those before it are there; called by one
  // thread at a time, whichever has answered last.
  using Take = std::function<void(AnsweredPose)>;

  PoseSpread(std::size_t threads, Answer answer, Take take);
  // Leaves poses that no thread has begun unanswered.
  ~PoseSpread();
  PoseSpread(const PoseSpread&) = delete;
  PoseSpread& operator=(const PoseSpread&) = delete;

  // Adds a pose; waits while many are not yet taken. Throws what the first pose that failed threw.
  void add(AskedPose asked);
  // Waits until all are taken. Throws the same: the answers of all poses before it were taken.
  void finish();

 private:
  struct Slot {
    AskedPose asked;
    AnsweredPose answered;
    std::exception_ptr failure;
    bool is_done = false;
  };
  static constexpr std::size_t kWaiting = 64;  // most poses for each thread that are not yet taken

  void work(std::size_t thread);
  void take_those_ready(std::unique_lock<std::mutex>& lock);
  void stop();

  Answer answer_;
  Take take_;
  std::mutex mutex_;  // guards all below
  std::condition_variable is_asked_, is_taken_;
  std::deque<Slot> slots_;                 // those not yet taken, which stay where they are
  std::size_t first_ = 0, next_ = 0;       // indices of the first one and of the next to answer
  bool is_taking_ = false, ends_ = false;  // no more will be added, or a pose has failed
  std::exception_ptr failure_;             // of the first pose that failed
  std::vector<std::thread> threads_;
};

}  // namespace vpm::tools
