#include "libvpm/setup/measured_check.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace vpm {
namespace {

constexpr std::size_t kMostPieces = 256;  // at most this many, evenly chosen from a tool

// Returns the numbers of poses in words; of many the first ones, and how many others there are.
std::string named(const std::vector<std::size_t>& numbers) {
  constexpr std::size_t kMostNamed = 3;
  const std::size_t count = numbers.size(), some = count > kMostNamed ? kMostNamed - 1 : count;
  std::string text = count > 1 ? "poses " : "pose ";
  for (std::size_t k = 0; k < some; ++k)
    text += (k == 0 ? "" : k + 1 < count ? ", " : " and ") + std::to_string(numbers[k]);
  return some < count ? text + " and " + std::to_string(count - some) + " others" : text;
}

}  // namespace

ContinuedDepth::ContinuedDepth(const DepthSurface& surface, std::span<const std::size_t> removed,
                               double length)
    : k_(surface.k), width_(surface.width), height_(surface.height), length_(length) {
  depth_.reserve(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (std::int32_t v = 0; v < height_; ++v) {
    for (std::int32_t u = 0; u < width_; ++u) {
      const double inverse = surface.measured_at(u, v);
      depth_.push_back(inverse > 0 ? 1 / inverse : 0);
    }
  }
  for (std::int32_t v = 0; v < height_; ++v)
    continue_line([&](std::int32_t u) -> double& { return at(u, v); }, width_, k_.fx* length);
  for (std::int32_t u = 0; u < width_; ++u)
    continue_line([&](std::int32_t v) -> double& { return at(u, v); }, height_, k_.fy* length);
  for (const std::size_t pixel : removed) depth_[pixel] = 0;
}

template <class At>
void ContinuedDepth::continue_line(const At& at, std::int32_t count, double size) {
  for (std::int32_t begin = 0; begin < count; ++begin) {
    if (at(begin) > 0) continue;
    std::int32_t end = begin;
    while (end < count && !(at(end) > 0)) ++end;
    const double before = begin > 0 ? at(begin - 1) : 0, after = end < count ? at(end) : 0;
    const bool is_hole = before > 0 && after > 0;
    for (std::int32_t i = begin; i < end; ++i) {
      const bool near_before = before > 0 && (i - begin + 1) * before <= size;
      const bool near_after = after > 0 && (end - i) * after <= size;
      if (is_hole) {
        at(i) = std::max(before, after);
      } else if (near_before || near_after) {
        at(i) = near_before ? before : after;
      }
    }
    begin = end;
  }
}

double ContinuedDepth::toward(Vec3 place) const {
  if (!(place.z > 0)) return 0;
  const double u = k_.fx * place.x / place.z + k_.cx, v = k_.fy * place.y / place.z + k_.cy;
  const double in_u = std::clamp(u, 0.0, width_ - 1.0), in_v = std::clamp(v, 0.0, height_ - 1.0);
  const bool is_near = std::abs(u - in_u) * place.z <= k_.fx * length_ &&
                       std::abs(v - in_v) * place.z <= k_.fy * length_;
  if (!is_near) return 0;
  const auto row = static_cast<std::size_t>(in_v + 0.5),
             column = static_cast<std::size_t>(in_u + 0.5);
  return depth_[row * static_cast<std::size_t>(width_) + column];
}

MeasuredCheck::MeasuredCheck(std::span<const ToolModel* const> tools, const DepthSurface& surface,
                             const CloudSensor& sensor)
    : tools_(tools),
      surface_(surface),
      camera_to_world_(sensor.camera.to_world),
      seen_(tools.size()) {
  for (std::size_t k = 0; k < sensor.depth.depth.size(); ++k)
    if (is_removed(sensor.depth.depth[k])) removed_.push_back(k);
}

bool MeasuredCheck::is_unmeasured(const ContinuedDepth& continued, const ToolPose& at) const {
  constexpr double kLittle = 1e-3;  // part of the tool's volume
  const ToolModel& model = *tools_[at.tool];
  const Pose to_camera = inverse(camera_to_world_) * at.pose;
  const std::vector<CellSample>& pieces = model.levels.back().samples;
  const std::size_t every = pieces.size() / kMostPieces + 1;
  double all = 0, inside = 0, inside_unknown = 0;
  for (std::size_t k = 0; k < pieces.size(); k += every) {
    const CellSample& piece = pieces[k];
    all += piece.weight;
    const Vec3 place = to_camera * (model.center_of_mass + widen(piece.center));
    const SurfaceSample sample = surface_.sample(place);
    const double depth = sample.known ? 0 : continued.toward(place);
    if (!sample.known && depth == 0) continue;
    const double distance = sample.known ? sample.distance : depth - place.z;
    if (distance < -2 * model.radius) continue;
    const double part = piece.weight * std::clamp(0.5 - 0.5 * distance / piece.radius, 0.0, 1.0);
    inside += part;
    if (!sample.known) inside_unknown += part;
  }
  return 4 * inside_unknown > inside && inside_unknown > kLittle * all;
}

MeasuredCheck::Found MeasuredCheck::found() const {
  Found found{poses_.kept().size(), 0, {}};
  if (found.poses == 0) return found;
  double reach = 0;
  for (const ToolModel* const model : tools_) reach = std::max(reach, model->radius);
  const ContinuedDepth continued(surface_, removed_, 2 * reach);
  for (const ToolPose& at : poses_.kept()) {
    if (!is_unmeasured(continued, at)) continue;
    ++found.unmeasured;
    found.numbers.push_back(at.number);
  }
  std::ranges::sort(found.numbers);
  const auto again = std::ranges::unique(found.numbers);
  found.numbers.erase(again.begin(), again.end());
  return found;
}

std::optional<Remark> MeasuredCheck::remark(const Found& found) const {
  if (found.unmeasured == 0) return std::nullopt;
  return Remark{true,
                "at " + named(found.numbers) + (poses_.stride() > 1 ? " of those looked at" : "") +
                    " a quarter or more of the tool behind the surface lies where nothing "
                    "was measured, and counts for nothing: move the camera, or fill the holes"};
}

}  // namespace vpm
