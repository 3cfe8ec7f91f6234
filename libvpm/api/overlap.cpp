#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/query/contact_list.h"
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

// Returns a power of two by whose multiples quantities up to `most` are told, so that sums of
// several are exact.
double step_for(double most) {
  constexpr int kBits = 49;
  return std::ldexp(1.0, std::ilogb(most) - kBits);
}

// Gives the largest contact what rounding leaves of the whole, so that contacts add up to that in
// any order. Drops those whose volume is below a bit of the whole's.
void complete(std::vector<Contact>& contacts, const Overlap& whole) {
  if (contacts.empty()) return;
  const double bit = std::ldexp(1.0, std::ilogb(whole.volume) - 52);
  for (Contact& contact : contacts) contact.volume = rounded_to(bit, contact.volume);
  std::erase_if(contacts, [](const Contact& c) { return c.volume <= 0; });
  leave_rest_to_first(contacts, whole.volume, whole.wrench);
}

}  // namespace

SolidBody::SolidBody(const Tool& tool, bool with_force)
    : surface_(prepared_surface(HandleAccess::held(tool), with_force)),
      model_(HandleAccess::shared(tool)) {}

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
  double force_step, torque_step;

  Wrench wrench(Vec3 force, Vec3 torque) const {
    return {rounded_to(force_step, options.stiffness * force),
            rounded_to(torque_step, options.stiffness * torque)};
  }
};

OverlapQuery::OverlapQuery(const SolidBody& a, const SolidBody& b, const OverlapOptions& options) {
  const auto &first = HandleAccess::shared(a), &second = HandleAccess::shared(b);
  check(*first, *second, options);
  // A contact pushes by its volume at most.
  const double most = options.stiffness * std::min(first->volume(), second->volume());
  const double reach = std::min(first->reach(), second->reach());
  impl_ = std::make_unique<Impl>(
      Impl{SolidPair(first, second), options, step_for(most), step_for(most * reach)});
}
OverlapQuery::~OverlapQuery() = default;
OverlapQuery::OverlapQuery(OverlapQuery&&) noexcept = default;
OverlapQuery& OverlapQuery::operator=(OverlapQuery&&) noexcept = default;

OverlapQuery::Impl& OverlapQuery::impl() const {
  return held_by(impl_, "OverlapQuery");
}

Overlap OverlapQuery::run(const Pose& pose_a, const Pose& pose_b) {
  Impl& held = impl();
  const auto& [with_force, stiffness, contacts] = held.options;
  const SharedSolid shared =
      held.pair.measure(exact_pose(pose_a), exact_pose(pose_b), with_force, contacts);
  Overlap overlap{shared.volume,
                  shared.centroid,
                  shared.area,
                  shared.turn,
                  held.wrench(shared.force, shared.torque),
                  shared.closure,
                  {}};
  for (const SharedContact& c : shared.contacts)
    overlap.contacts.push_back({0, c.volume, c.centroid, normalized_or_zero(c.area), norm(c.area),
                                c.depth, held.wrench(c.force, c.torque), c.patches});
  complete(overlap.contacts, overlap);
  return overlap;
}

Overlap overlap(const SolidBody& a, const Pose& pose_a, const SolidBody& b, const Pose& pose_b,
                const OverlapOptions& options) {
  return OverlapQuery(a, b, options).run(pose_a, pose_b);
}

}  // namespace vpm
