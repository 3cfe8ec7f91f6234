#include <vpm/solid.h>

#include <cmath>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/query/solid_query.h"
#include "libvpm/solid/solid_pair.h"

namespace vpm {
namespace {

[[noreturn]] void invalid(const std::string& what, const std::string& hint) {
  throw Error(ErrorKind::invalid_argument, what, {}, hint);
}

void check(const SolidSurface& a, const SolidSurface& b, const OverlapOptions& options) {
  if (!(options.stiffness > 0 && std::isfinite(options.stiffness)))
    invalid("the stiffness is not positive and finite", "give a number above 0, in N/m^3");
  if (options.with_force && !(a.has_depth() && b.has_depth()))
    invalid("a body was made without what forces need",
            "make both with `with_force`, or ask without");
}

}  // namespace

SolidBody::SolidBody(const Tool& tool, bool with_force)
    : surface_(prepared_surface(HandleAccess::held(tool), with_force)) {}

double SolidBody::volume() const {
  return HandleAccess::shared(*this)->volume();
}
Vec3 SolidBody::center_of_mass() const {
  return HandleAccess::shared(*this)->center_of_mass();
}
double SolidBody::radius() const {
  return HandleAccess::shared(*this)->reach();
}
std::size_t SolidBody::triangles() const {
  return HandleAccess::shared(*this)->triangles();
}

struct OverlapQuery::Impl {
  SolidPair pair;
  OverlapOptions options;
};

OverlapQuery::OverlapQuery(const SolidBody& a, const SolidBody& b, const OverlapOptions& options) {
  const auto &first = HandleAccess::shared(a), &second = HandleAccess::shared(b);
  check(*first, *second, options);
  impl_ = std::make_unique<Impl>(Impl{SolidPair(first, second), options});
}
OverlapQuery::~OverlapQuery() = default;
OverlapQuery::OverlapQuery(OverlapQuery&&) noexcept = default;
OverlapQuery& OverlapQuery::operator=(OverlapQuery&&) noexcept = default;

OverlapQuery::Impl& OverlapQuery::impl() const {
  return held_by(impl_, "OverlapQuery");
}

Overlap OverlapQuery::run(const Pose& pose_a, const Pose& pose_b) {
  Impl& held = impl();
  const auto& [with_force, stiffness] = held.options;
  const SharedSolid shared = held.pair.measure(exact_pose(pose_a), exact_pose(pose_b), with_force);
  return {shared.volume,
          shared.centroid,
          shared.area,
          shared.turn,
          {stiffness * shared.force, stiffness * shared.torque},
          shared.closure};
}

Overlap overlap(const SolidBody& a, const Pose& pose_a, const SolidBody& b, const Pose& pose_b,
                const OverlapOptions& options) {
  return OverlapQuery(a, b, options).run(pose_a, pose_b);
}

}  // namespace vpm
