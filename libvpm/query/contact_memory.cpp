#include "libvpm/query/contact_memory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vpm {
namespace {

// Parts of the limits within which what is read is used: of what is read for the first time, lest
// all that is read together is read again together; and of what is read again.
constexpr double kLeastFirst = 0.3, kLeastAgain = 0.9;

// From [0, 1): evenly spread over clusters and poses.
double spread(std::uint32_t cluster, std::uint64_t pose) {
  constexpr double kRange = 4294967296;  // 2^32
  constexpr std::uint32_t kClusters = 2654435769, kPoses = 1640531527;
  return (kClusters * cluster + kPoses * static_cast<std::uint32_t>(pose)) / kRange;
}

// The surface seen from the tool `now`, where it was seen from `then`; lengths in the tool's reach.
SmallMotion small_motion(const Pose& then, const Pose& now, double inverse_reach) {
  const Pose motion = relative_to(now, then);
  const Rotation& r = motion.rotation;
  return {inverse_reach * motion.translation,
          0.5 * Vec3{r.row2.y - r.row1.z, r.row0.z - r.row2.x, r.row1.x - r.row0.y}};
}

// How far a place no further than `reach` from the origin moves at most.
double way(const Pose& from, const Pose& to, double reach) {
  const Rotation &a = from.rotation, &b = to.rotation;
  const double squared =
      squared_norm(a.row0 - b.row0) + squared_norm(a.row1 - b.row1) + squared_norm(a.row2 - b.row2);
  return norm(to.translation - from.translation) +
         reach * std::sqrt(squared) / std::numbers::sqrt2;  // 2 sin(angle / 2)
}

}  // namespace

void ContactMemory::turn(std::uint64_t cloud, const Pose& to_surface) {
  if (cloud != cloud_) forget();
  cloud_ = cloud;
  ++pose_;
  std::fill(uses_.begin(), uses_.end(), Use::none);
  origin(pose_).to_surface = to_surface;
  const std::uint64_t oldest = pose_ > kOrigins ? pose_ - kOrigins + 1 : 1;
  for (std::uint64_t pose = std::max(oldest, forget_before_); pose <= pose_; ++pose) {
    Origin& then = origin(pose);
    then.moved = way(then.to_surface, to_surface, reach_.length);
    then.motion = small_motion(then.to_surface, to_surface, reach_.inverse);
  }
}

bool ContactMemory::use(std::uint32_t cluster) {
  const Age& age = ages_[cluster];
  const bool is_of_use =
      is_young(age) &&
      (!age.is_empty || contacts_[cluster].clearance.holds(origin(age.read).motion));
  if (is_of_use) uses_[cluster] = Use::again;
  return is_of_use;
}

void ContactMemory::add(std::uint32_t cluster, ToolSum& sum) const {
  if (is_empty(cluster)) return;
  const Contact& contact = contacts_[cluster];
  SumChange change =
      contact.slopes.change(origin(ages_[cluster].read).motion, contact.sum.force_terms());
  const double part = contact.sum.volume.real();
  if (!(part + change.part > 0)) return;  // it has come out
  change.part = std::min(change.part, weights_[cluster] - part);
  sum.add(contact.sum);
  sum.add(change);
}

void ContactMemory::end(std::uint32_t cluster) {
  const Contact& contact = contacts_[cluster];
  const bool tells = contact.is_empty() ? contact.clearance.height > 0
                                        : contact.slopes.most_passing(reach_.inverse * limit_) <=
                                              weights_[cluster];
  if (!tells) return;
  ages_[cluster] = age(cluster, ages_[cluster]);
  ages_[cluster].is_empty = contact.is_empty();
}

ContactMemory::Age ContactMemory::age(std::uint32_t index, const Age& before) const {
  const bool is_first = before.read < forget_before_ || before.read + kOrigins <= pose_;
  const double least = is_first ? kLeastFirst : kLeastAgain;
  const double part = least + (1 - least) * spread(index, pose_);
  return {pose_, pose_ + 1 + static_cast<std::uint64_t>(part * (kOrigins - 1)), part * limit_};
}

}  // namespace vpm
