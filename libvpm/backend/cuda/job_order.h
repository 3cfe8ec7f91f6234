// Orders the jobs of a batch by their tools, which a launch takes one after another.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/core/parallel.h"
#include "libvpm/measure/body_sum.h"

namespace vpm::cuda {

// Holds the jobs of one launch, ordered by tool. Memory is used again.
class JobOrder {
 public:
  // Names the jobs of one tool: they follow those of the tool before.
  struct Part {
    std::uint32_t tool = 0;
    unsigned end = 0;
  };

  // Counts and sorts: tools that have jobs, in their order, and of each the jobs in theirs. Stores
  // the poses in that order. The jobs of one tool are in order, so all threads store their poses.
  void order(std::span<const BodyJob> jobs, std::size_t tools, Pose* poses) {
    places_.clear();
    if (tools == 1 && !jobs.empty()) {
      parts_.assign(1, {0, static_cast<unsigned>(jobs.size())});
      constexpr std::size_t kPosesPerTask = 1024;
      parallel_for(jobs.size(), kPosesPerTask, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) poses[k] = jobs[k].to_body;
      });
      return;
    }
    next_.assign(tools + 1, 0);
    for (const BodyJob& job : jobs) ++next_[job.tool + 1];
    parts_.clear();
    for (std::uint32_t t = 0; t < tools; ++t) {
      const bool has_jobs = next_[t + 1] > 0;
      next_[t + 1] += next_[t];
      if (has_jobs) parts_.push_back({t, next_[t + 1]});
    }
    places_.resize(jobs.size());
    for (std::uint32_t k = 0; k < jobs.size(); ++k) {
      const std::uint32_t place = next_[jobs[k].tool]++;
      poses[place] = jobs[k].to_body;
      places_[place] = k;
    }
  }

  const std::vector<Part>& parts() const { return parts_; }
  // Returns the job that an ordered pose is from.
  std::size_t place(std::size_t k) const { return places_.empty() ? k : places_[k]; }

 private:
  std::vector<Part> parts_;
  std::vector<std::uint32_t> places_, next_;  // of several tools
};

}  // namespace vpm::cuda
