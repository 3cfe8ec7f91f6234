#include "libvpm/setup/enclosed_check.h"

#include <algorithm>
#include <string>

#include "libvpm/core/solid_angle.h"
#include "libvpm/scene/points/disk_winding.h"

namespace vpm {

PointWinding::PointWinding(const Cloud& cloud) : origin_(cloud.origin) {
  constexpr std::size_t kMostPoints = 2000;
  const std::size_t every = cloud.size() / kMostPoints + 1;
  for (std::size_t k = 0; k < cloud.size(); k += every) {
    // A disk's radius is about the spacing of points, so that its square is the area of one.
    const double area = double{cloud.radii[k]} * cloud.radii[k] * static_cast<double>(every);
    dipoles_.push_back({widen(cloud.positions[k]), area * widen(cloud.normals[k])});
  }
}

double PointWinding::at(Vec3 place) const {
  const Vec3 from = place - origin_;
  double sum = 0;
  for (const Dipole& dipole : dipoles_) {
    const Vec3 to = dipole.place - from;
    // A disk that is near fills a part of the view only.
    const double squared = dot(to, to) + norm(dipole.area);
    sum += dipole_angle(dipole.area, to, squared);
  }
  return sum / kFullSolidAngle;
}

void EnclosedCheck::see(const Pose& pose, std::size_t k, const Result& result) {
  constexpr double kLittle = 0.1;  // part of the tool's volume
  if (result.volume < kLittle * tools_[k]->volume) doubtful_.add({pose, k});
}

std::optional<Remark> EnclosedCheck::remark() const {
  // A place that more directions lead behind the points from than before them is inside for a
  // query. Of one with half as many nobody can tell.
  constexpr double kUnknown = DiskWinding::kMayBeInside;
  const auto found = std::ranges::count_if(doubtful_.kept(), [&](const ToolPose& at) {
    return winding_.at(at.pose * tools_[at.tool]->spheres.front().center) > kUnknown;
  });
  if (found == 0) return std::nullopt;
  const bool are_all = doubtful_.stride() == 1;
  return Remark{true, "at " + std::to_string(found) + (are_all ? "" : " or more") +
                          " of the poses the tool is behind points that show one side only: "
                          "whether it is inside is not known, and nothing counts; points from all "
                          "sides would tell, or depth images with their cameras"};
}

}  // namespace vpm
