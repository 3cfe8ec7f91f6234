// Computes the measure as printed: Kaluschke, Weller, Zachmann, "A Volumetric Penetration Measure
// for 6-DOF Haptic Rendering of Streaming Point Clouds" (2017), less two misprints
// (measure/README.md).
#pragma once

#include <vpm/query_types.h>

#include <vector>

#include "libvpm/backend/cpu/points_inside.h"
#include "libvpm/core/pose.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/measure/paper_contact.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/scene/any_body.h"

namespace vpm {

class PaperMeasure {
 public:
  PaperMeasure(const ToolModel& tool, const Level& level);

  // Fills `states`, which has one entry per sphere. Allocates nothing after the first call.
  BodySum run(const AnyBody& body, const Pose& pose, std::vector<SphereState>& states);

 private:
  template <class Points>
  std::uint32_t gather(const Points& points, const Pose& pose);
  void find_boundary(std::vector<SphereState>& states);
  void flood(std::vector<SphereState>& states);
  void enter(std::vector<SphereState>& states);
  BodySum total(const std::vector<SphereState>& states) const;

  // The sums of a contact can count all points.
  static_assert(kMaxPoints <= std::size_t{1} << PaperContact::kPointBits);

  const ToolModel& tool_;
  const Level& level_;
  std::vector<PaperContact> contacts_;
  std::vector<Vec3> normals_;  // n_s of boundary, n_j of inside spheres, tool axes
  std::vector<std::uint32_t> front_, next_front_;
  PointRanges ranges_;
  std::vector<std::uint32_t> depth_;  // flood level of inside spheres, 1 at the entry
};

}  // namespace vpm
