#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/api/overlap_answer.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/core/parallel.h"
#include "libvpm/query/contact_list.h"
#include "libvpm/query/solid_query.h"
#include "libvpm/solid/device_solids.h"

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

OverlapAnswer::OverlapAnswer(const SolidSurface& a, const SolidSurface& b,
                             const OverlapOptions& options)
    : options_(options) {
  check(a, b, options);
  // A contact pushes by its volume at most.
  const double most = options.stiffness * std::min(a.volume(), b.volume());
  force_step_ = step_for(most), torque_step_ = step_for(most * std::min(a.reach(), b.reach()));
}

Wrench OverlapAnswer::wrench(Vec3 force, Vec3 torque) const {
  return {rounded_to(force_step_, options_.stiffness * force),
          rounded_to(torque_step_, options_.stiffness * torque)};
}

Overlap OverlapAnswer::of(const SharedSolid& shared) const {
  Overlap overlap{shared.volume,
                  shared.centroid,
                  shared.area,
                  shared.turn,
                  wrench(shared.force, shared.torque),
                  shared.closure,
                  {}};
  for (const SharedContact& c : shared.contacts)
    overlap.contacts.push_back({0, c.volume, c.centroid, normalized_or_zero(c.area), norm(c.area),
                                c.depth, wrench(c.force, c.torque), c.patches});
  complete(overlap.contacts, overlap);
  return overlap;
}

struct OverlapQuery::Impl {
  std::shared_ptr<const SolidSurface> a, b;
  OverlapAnswer answer;
  SolidPair pair;
  std::unique_ptr<DeviceSolids> device;  // null where the CPU measures

  Impl(const SolidBody& of_a, const SolidBody& of_b, const OverlapOptions& options)
      : a(HandleAccess::shared(of_a)),
        b(HandleAccess::shared(of_b)),
        answer(*a, *b, options),
        pair(a, b) {
    if (is_for_device(options))
      device = std::make_unique<DeviceSolids>(options.device, std::vector{a, b});
  }
  // Returns what a device tells of the jobs, if there is one.
  std::vector<std::optional<SharedSolid>> told(std::span<const SolidJob> jobs) {
    return device ? device->run(jobs) : std::vector<std::optional<SharedSolid>>(jobs.size());
  }
  Overlap measured(SolidPair& by, const Pose& pose_a, const Pose& pose_b) const {
    const OverlapOptions& options = answer.options();
    return answer.of(by.measure(pose_a, pose_b, options.with_force, options.contacts));
  }
};

OverlapQuery::OverlapQuery(const SolidBody& a, const SolidBody& b, const OverlapOptions& options)
    : impl_(std::make_unique<Impl>(a, b, options)) {}
OverlapQuery::~OverlapQuery() = default;
OverlapQuery::OverlapQuery(OverlapQuery&&) noexcept = default;
OverlapQuery& OverlapQuery::operator=(OverlapQuery&&) noexcept = default;

OverlapQuery::Impl& OverlapQuery::impl() const {
  return held_by(impl_, "OverlapQuery");
}

Overlap OverlapQuery::run(const Pose& pose_a, const Pose& pose_b) {
  Impl& held = impl();
  const SolidJob job{0, 1, exact_pose(pose_a), exact_pose(pose_b)};
  if (held.device)
    if (const auto told = held.device->run({&job, 1}).front()) return held.answer.of(*told);
  return held.measured(held.pair, job.pose_a, job.pose_b);
}

void OverlapQuery::run(std::span<const Pose> a, std::span<const Pose> b,
                       std::span<Overlap> answers) {
  constexpr std::size_t kPosesPerTask = 32;  // each takes a pair of its own
  Impl& held = impl();
  if (a.size() != b.size() || a.size() != answers.size())
    throw Error(ErrorKind::invalid_argument, "there are " + std::to_string(a.size()) +
                                                 " poses of a, " + std::to_string(b.size()) +
                                                 " of b and " + std::to_string(answers.size()) +
                                                 " answers");
  std::vector<SolidJob> jobs(a.size());
  for (std::size_t k = 0; k < jobs.size(); ++k)
    jobs[k] = {0, 1, exact_pose(a[k]), exact_pose(b[k])};
  const auto told = held.told(jobs);
  parallel_for(jobs.size(), kPosesPerTask, [&](std::size_t begin, std::size_t end) {
    std::optional<SolidPair> pair;
    for (std::size_t k = begin; k < end; ++k) {
      if (!told[k] && !pair) pair.emplace(held.a, held.b);
      answers[k] =
          told[k] ? held.answer.of(*told[k]) : held.measured(*pair, jobs[k].pose_a, jobs[k].pose_b);
    }
  });
}

Overlap overlap(const SolidBody& a, const Pose& pose_a, const SolidBody& b, const Pose& pose_b,
                const OverlapOptions& options) {
  return OverlapQuery(a, b, options).run(pose_a, pose_b);
}

}  // namespace vpm
