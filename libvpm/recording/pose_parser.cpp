#include "libvpm/recording/pose_parser.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/recording/pose_json.h"
#include "libvpm/recording/pose_numbers.h"

namespace vpm {
namespace {

// True if a number is not finite, or all are zero.
bool are_undefined(const std::vector<double>& numbers) {
  const auto is_infinite = [](double number) { return !std::isfinite(number); };
  return std::any_of(numbers.begin(), numbers.end(), is_infinite) ||
         std::all_of(numbers.begin(), numbers.end(), [](double number) { return number == 0; });
}

}  // namespace

bool PoseParser::take_names(const std::string& text, std::size_t line) {
  std::optional<PoseNames> found = names_in(text, line);
  if (!found) return false;
  if (!found->orders.empty() || !names_) names_ = std::move(found);
  return true;
}

void PoseParser::forget_last() {
  time_.reset();
  is_undefined_ = false;
}

Pose PoseParser::rigid(const std::vector<double>& numbers) {
  is_undefined_ = are_undefined(numbers);
  double deviation = 0;
  const Pose pose = from_untimed(numbers, &deviation);
  largest_deviation_ = std::max(largest_deviation_, deviation);
  return pose;
}

ToldPose PoseParser::of_numbers(std::vector<double> n, std::optional<double> time) {
  const bool is_matrix = n.size() == kMatrix || n.size() == kThreeRows;
  if (names_ && !(is_matrix && !fitting_order(names_->orders, n.size())))
    n = in_usual_order(n, *names_);
  if (n.size() == kTimedPose && !time) {
    time = seconds_of_stamp(n.front());
    n.erase(n.begin());
  }
  time_ = time;  // also told of a pose that is refused
  return {rigid(n), time};
}

ToldPose PoseParser::of_value(const nlohmann::json& value) {
  if (!value.is_object()) return of_numbers(numbers_of(value));
  refuse_misspelt_keys(value);
  const std::optional<double> time = time_of(value);
  const ObjectPose pose = pose_of_object(value);
  time_ = time;
  ToldPose found =
      pose.are_named ? ToldPose{rigid(pose.numbers), time} : of_numbers(pose.numbers, time);
  if (value.contains("id")) found.id = value["id"].dump();
  if (value.contains("solids")) found.solids = poses_of_solids(value["solids"], largest_deviation_);
  return found;
}

std::optional<ToldPose> PoseParser::of_plain_line(const std::string& line) {
  forget_last();
  try {
    if (!is_json(line)) {
      std::vector<double> numbers;
      if (line.find('#') == line.npos) numbers = numbers_of_line(line);
      if (numbers.size() < kQuaternionPose) return std::nullopt;  // a comment, or a matrix's row
      return of_numbers(std::move(numbers));
    }
    const nlohmann::json value = json_or_print(line);
    if (value.is_discarded() || list_of_poses(value) != nullptr) return std::nullopt;
    return of_value(value);
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace vpm
