#include "libvpm/query/query.h"

#include <cmath>

#include "libvpm/core/error.h"
#include "libvpm/query/points_inside.h"

namespace vpm {

Query::Query(const ToolModel& tool, const QueryOptions& options)
    : tool_(tool),
      level_(tool.level(options.level)),
      options_(options),
      states_(level_.sphere_count) {
  if (!(options.stiffness > 0 && std::isfinite(options.stiffness))) {
    throw Error(ErrorKind::usage, "the stiffness must be a positive number");
  }
  if (options.measure == Measure::paper) {
    paper_ = std::make_unique<PaperMeasure>(tool, level_, options.location);
  } else {
    refined_ = std::make_unique<RefinedMeasure>(tool, level_);
  }
}

Result Query::run(const PreparedCloud& cloud, const Pose& pose) {
  Result result;
  if (paper_) {
    result = paper_->run(cloud, pose, states_);
  } else {
    result = refined_->run(cloud, pose, states_);
    result.points = for_points_inside(cloud, tool_, level_, PointLocation::grid, pose, ranges_,
                                      [](std::uint32_t, std::uint32_t, Vec3) {});
  }
  result.wrench.force = options_.stiffness * result.wrench.force;
  result.wrench.torque = options_.stiffness * result.wrench.torque;
  return result;
}

}  // namespace vpm
