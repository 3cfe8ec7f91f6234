#include "libvpm/recording/camera_pose_file.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/recording/json_numbers.h"
#include "libvpm/recording/pose_reader.h"

namespace vpm {
namespace {

using nlohmann::json;

Pose from_matrix(const std::vector<double>& m, double* deviation) {
  if (m.size() != 16 || m[12] != 0 || m[13] != 0 || m[14] != 0 || m[15] != 1)
    refuse("a camera's matrix has 4x4 numbers by rows, the last row 0 0 0 1");
  return {rotation_from_matrix({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]}, deviation),
          {m[3], m[7], m[11]}};
}

std::vector<double> transposed(const std::vector<double>& m) {
  if (m.size() != 16) return m;
  std::vector<double> turned(16);
  for (std::size_t i = 0; i < 16; ++i) turned[i] = m[4 * (i % 4) + i / 4];
  return turned;
}

// Returns the pose of a JSON object; empty if it has none of the keys.
std::optional<Pose> from_object(const json& object, double* deviation) {
  if (object.contains("extrinsic"))
    return inverse(from_matrix(transposed(numbers_of(object["extrinsic"])), deviation));
  for (const char* key : {"matrix", "transform_matrix", "camera_pose", "pose"}) {
    if (!object.contains(key)) continue;
    const std::vector<double> n = numbers_of(object[key]);
    if (n.size() != 7) return from_matrix(n, deviation);
    return Pose{rotation_from_quaternion({n[3], n[4], n[5], n[6]}, deviation), {n[0], n[1], n[2]}};
  }
  return std::nullopt;
}

Pose only_pose(const std::string& path, double* deviation) {
  PoseReader reader(path);
  const std::optional<Pose> pose = reader.next();
  if (!pose) reader.refuse_empty();
  if (reader.next())
    refuse("it holds several poses", path,
           "give a file with the one of this image, or its numbers");
  if (deviation != nullptr) *deviation = reader.largest_deviation();
  return *pose;
}

}  // namespace

Pose read_camera_pose(const std::string& path, double* deviation) {
  const std::vector<std::byte> bytes = file::read_all(path);
  const json object = json::parse(
      file::as_text(bytes), [](int depth, json::parse_event_t, const json&) { return depth < 16; },
      false);
  if (object.is_object()) {
    try {
      if (const auto pose = from_object(object, deviation)) return *pose;
    } catch (const Error& fault) {
      refuse(fault.problem(), path, fault.hint());
    }
  }
  return only_pose(path, deviation);
}

}  // namespace vpm
