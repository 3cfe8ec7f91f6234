// Answers poses by several threads, and hands the answers over in the order of the poses.
#pragma once

#include <vpm/query_types.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "libvpm/recording/pose_reader.h"
#include "tools/query/query_report.h"

namespace vpm::tools {

// Poses that follow each other, which one thread answers: either read, or a line for each.
struct PoseChunk {
  std::size_t first = 0;              // index of the first pose
  std::vector<AskedPose> poses = {};  // that were read
  PoseLines lines = {};               // that were not

  std::size_t count() const { return poses.size() + lines.count; }
};

// A pose with its answer.
struct AnsweredPose {
  AskedPose asked;
  Result result;                     // unless only collisions are asked for
  std::optional<Collides> collides;  // if they are
  std::string above;                 // Collisions::show() of it
  double seconds = 0;                // that the answer took
};

// The answers of the first poses of a chunk, and why they are not all.
struct AnsweredChunk {
  std::vector<AnsweredPose> poses;
  std::string text;              // lines of results
  std::size_t read_bytes = 0;    // of the lines
  double largest_deviation = 0;  // of rotations of the chunk
  std::exception_ptr failure;    // of the pose after them
};

class PoseSpread {
 public:
  // Answers a chunk; called by the thread that it was made on.
  using Answer = std::function<AnsweredChunk(const PoseChunk& chunk)>;
  // Takes answers in order, all that are there with those before them; called by one thread at a
  // time, whichever has answered last. Only the last of them may have a failure, which ends the
  // spread, as does what this throws.
  using Take = std::function<void(std::vector<AnsweredChunk> answered)>;

  // Starts the threads. Each calls `make_answer` first, so that what it answers with lies in memory
  // of its own.
  PoseSpread(std::size_t threads, std::function<Answer()> make_answer, Take take);
  // Leaves poses that no thread has begun unanswered.
  ~PoseSpread();
  PoseSpread(const PoseSpread&) = delete;
  PoseSpread& operator=(const PoseSpread&) = delete;

  // Adds poses; waits while many are not yet taken. They are cut into chunks that take about half
  // a millisecond, as those before tell, and less where threads would be idle. Throws what
  // the first chunk that failed threw, as it was answered or taken; these poses are added even so.
  void add(const PoseChunk& poses);
  // Waits until all are taken. Throws the same.
  void finish();
  // Ends the threads. Returns all that was added and not taken, in order; first the chunk that
  // failed, if an answer did.
  std::vector<PoseChunk> stop();

 private:
  struct Slot {
    PoseChunk chunk;
    AnsweredChunk answered;
    bool is_done = false;
  };
  static constexpr std::size_t kWaiting = 256;  // most poses for each thread that are not yet taken

  void add_chunk(PoseChunk chunk);
  std::size_t size_of_chunk(std::size_t left);
  void work();
  void note_time(double seconds_per_pose);
  void answer_chunks(const Answer& answer, std::unique_lock<std::mutex>& lock);
  void take_those_ready(std::unique_lock<std::mutex>& lock);
  void fail(std::exception_ptr failure);

  std::function<Answer()> make_answer_;
  Take take_;
  std::mutex mutex_;  // guards all below
  std::condition_variable is_asked_, is_taken_;
  std::deque<Slot> slots_;                 // those not yet taken, which stay where they are
  std::size_t next_ = 0;                   // place in slots_ of the next one to answer
  std::size_t waiting_ = 0;                // poses in slots_
  double seconds_per_pose_ = 0;            // of the chunks before: rises at once, falls slowly
  bool is_taking_ = false, ends_ = false;  // no more will be added, or a chunk has failed
  std::exception_ptr failure_;             // of the first chunk that failed
  std::vector<std::thread> threads_;
};

}  // namespace vpm::tools
