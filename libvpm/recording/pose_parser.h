// Understands one pose: its numbers, or a value of JSON.
#pragma once

#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/core/pose.h"
#include "libvpm/recording/pose_columns.h"

namespace vpm {

// A pose with what stands beside it.
struct ToldPose {
  Pose pose;
  std::optional<double> time;     // s; empty without one
  std::string id = {};            // JSON; empty without one
  std::vector<Pose> solids = {};  // empty without any
};

// Forms of a pose are those of PoseReader. Copies parse apart: one for each thread.
class PoseParser {
 public:
  // Takes the names of columns in a line; false if it has none.
  bool take_names(const std::string& text, std::size_t line);

  // Takes 7 numbers, 8 with the time first, or a matrix; where columns are named, in their order.
  // Throws Error(refused), as all below, without a place.
  ToldPose of_numbers(std::vector<double> numbers, std::optional<double> time = {});
  ToldPose of_value(const nlohmann::json& value);

  // Returns the pose of a line that tells one pose, whatever stands before and after it; empty for
  // every other line, also for one that is to be refused.
  std::optional<ToldPose> of_plain_line(const std::string& line);

  // Returns the time of the last pose, also of one that was refused.
  std::optional<double> time() const { return time_; }
  // True if the last pose has numbers that are not finite, or only zeros; also of one that was
  // refused.
  bool is_undefined() const { return is_undefined_; }
  // Begins a pose: nothing is known of the last one.
  void forget_last();
  // Returns the largest deviation of a rotation before it was normalised.
  double largest_deviation() const { return largest_deviation_; }

 private:
  // Returns the pose of 7 numbers or a matrix; counts its deviation.
  Pose rigid(const std::vector<double>& numbers);

  std::optional<PoseNames> names_;
  std::optional<double> time_;
  bool is_undefined_ = false;
  double largest_deviation_ = 0;
};

}  // namespace vpm
