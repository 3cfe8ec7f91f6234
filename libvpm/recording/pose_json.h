// Reads poses of JSON, and of lists as numpy prints them.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/core/pose.h"

namespace vpm {

// True if a line begins as JSON, or a list as numpy prints it, does.
bool is_json(std::string_view line);

// Follows the brackets of JSON, or of a list as numpy prints it, from line to line.
class OpenBrackets {
 public:
  void add(std::string_view line);
  // True if a bracket is open, and what follows may still close it.
  bool are_open() const { return depth_ > 0 && !is_broken_; }

 private:
  void add_outside_of_text(char letter);

  std::size_t depth_ = 0;
  char last_ = 0;  // letter before, but for blanks
  bool is_in_text_ = false, is_escaped_ = false, is_broken_ = false;
};

// Returns the value of JSON, or of lists as numpy prints them, "[[1. 0.]\n [0. 1.]]"; a discarded
// value for any other text. Throws as file::refusing_doubt().
nlohmann::json json_or_print(std::string_view text);

// Returns the numbers of a list, or of a list of lists, row by row. Throws a refusal at anything
// else, and at a matrix whose rows are not of four numbers.
std::vector<double> numbers_of(const nlohmann::json& value);

// Returns the list of poses that the value is, or has as "poses"; null if it is none.
const nlohmann::json* list_of_poses(const nlohmann::json& value);

// Returns the time of an object in seconds, also that of a header of ROS; empty if it has none.
std::optional<double> time_of(const nlohmann::json& object);

// Numbers of a pose in an object.
struct ObjectPose {
  std::vector<double> numbers;
  bool are_named = false;  // tx ty tz qx qy qz qw, each by its key
};

// Returns the pose of an object: "pose", "matrix" or "transform_matrix", or position and
// orientation as ROS has them, also within "pose" or "transform"; or a list or object "tool".
// Throws a refusal that names the keys wanted.
ObjectPose pose_of_object(const nlohmann::json& object);

// Returns the keys of objects of poses that readers know.
std::span<const std::string> keys_of_poses();

// Throws a refusal of a key that is nearly one of those, which would be passed over in silence:
// other keys are of those who write the object.
void refuse_misspelt_keys(const nlohmann::json& object);

// Returns the poses of a list of a scene's solids, mesh to world: each a list of numbers or an
// object, as a tool's. Raises `largest_deviation` to that of their rotations. Throws a refusal for
// any other value, and for a list of none.
std::vector<Pose> poses_of_solids(const nlohmann::json& list, double& largest_deviation);

// Returns the pose of a camera's object; empty if it has none of the keys.
std::optional<Pose> camera_of_object(const nlohmann::json& object, double* deviation);

}  // namespace vpm
