#include "libvpm/solid/solid_pair.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

// Moves of the second solid, in units of the jitter: small whole numbers without pattern, so that
// identical solids at one place are in general position too.
constexpr Vec3 kShifts[OrderedPair::kAttempts]{{.31, -.47, .23}, {-.41, .29, .37},
                                               {.19, .43, -.33}, {-.27, -.39, -.49},
                                               {.45, .17, -.21}, {-.13, .35, .25}};
constexpr Vec3 kTurns[OrderedPair::kAttempts]{{.37, .21, -.43},  {.25, -.49, .31},
                                              {-.45, .33, .17},  {.41, -.19, .29},
                                              {-.23, -.35, .47}, {.15, .39, -.27}};

// Returns a motion of about the jitter: a rotation by less than 2^-36 is one of 1 and small
// entries, exact in double. Solids meet within one reach of the first's centre: a second one that
// is much larger turns by less, so that its far places move by no more than a few of these.
Pose small_motion(int attempt, double reach, double other_reach) {
  const double size = SolidSurface::kJitter;
  const Vec3 w = std::min(1.0, kMuchLarger * reach / other_reach) * size * kTurns[attempt];
  return {{{1, -w.z, w.y}, {w.z, 1, -w.x}, {-w.y, w.x, 1}}, size * reach * kShifts[attempt]};
}

auto key_of(const SolidSurface& s) {
  return std::tuple(s.reach(), s.volume(), s.hash());
}

// Adds a contact to the sum of others, but for the depth.
void add(SharedContact& sum, const SharedContact& contact) {
  const double volume = sum.volume + contact.volume;
  sum.centroid = (sum.volume * sum.centroid + contact.volume * contact.centroid) / volume;
  sum.volume = volume;
  sum.area += contact.area, sum.force += contact.force, sum.torque += contact.torque;
  sum.patches += contact.patches;
}

Pose about_center(const Pose& pose, const SolidSurface& solid) {
  return {pose.rotation, pose * solid.center_of_mass()};
}

[[noreturn]] void refuse_unlike(double unlikeness) {
  char text[160];
  std::snprintf(text, sizeof text,
                "one solid is %.3g times as large as the other: up to %.0f times what they share "
                "is told to a millionth of the smaller",
                unlikeness, SolidPair::kMostUnlike);
  refuse(text, {}, "cut it down to what is near");
}

}  // namespace

double depth_of_touch(double reach, double distance_from_origin) {
  constexpr double kMoves = 4, kRounding = 0x1p-50;
  return kMoves * SolidSurface::kJitter * reach + kRounding * (distance_from_origin + reach);
}

OrderedPair::OrderedPair(std::shared_ptr<const SolidSurface> a,
                         std::shared_ptr<const SolidSurface> b)
    : order_(key_of(*a), key_of(*b)),
      first_(order_.is_turned() ? b : a),
      second_(order_.is_turned() ? a : b) {}

OrderedPair::Place OrderedPair::place(const Pose& pose_a, const Pose& pose_b) const {
  const bool turned = order_.is_turned(pose_a, pose_b);
  const Pose first = about_center(turned ? pose_b : pose_a, *first_),
             second = about_center(turned ? pose_a : pose_b, *second_);
  return {turned, first, relative_to(first, second)};
}

bool OrderedPair::may_meet(const Place& place) const {
  return !(norm(place.relative.translation) > (1 + 1e-9) * (first_->reach() + second_->reach()));
}

Pose OrderedPair::moved(const Place& place, int attempt) const {
  return place.relative * small_motion(attempt, first_->reach(), second_->reach());
}

double OrderedPair::closure(const std::array<InnerSurface, 2>& inner) const {
  SurfaceMoments all = inner[0].moments;
  all.add(inner[1].moments);
  const double reach = std::min(first_->reach(), second_->reach());
  return std::max(norm(all.area) / (reach * reach), norm(all.turn()) / (reach * reach * reach));
}

double OrderedPair::unlikeness() const {
  const auto [less, more] = std::minmax({first_->reach(), second_->reach()});
  return more / less;
}

void OrderedPair::refuse_unclosed(double gap) const {
  char text[160];
  std::snprintf(
      text, sizeof text,
      "the boundary of what the two solids share does not close: its area vectors miss by "
      "%.1e of the smaller reach squared",
      gap);
  refuse(text, {}, "check both meshes for slits and folds; one that is repaired by voxels closes");
}

double OrderedPair::volume_of_touch(double area, const Place& place) const {
  double far = 0;
  for (const Vec3 center : {place.first.translation, place.first * place.relative.translation,
                            first_->center_of_mass(), second_->center_of_mass()})
    far = std::max(far, norm(center));
  const auto [less, more] = std::minmax({first_->reach(), second_->reach()});
  constexpr double kRounding = 0x1p-52;
  const double summed = std::min(more, unit_for(less, more));  // no farther are places in sums
  return depth_of_touch(more, far) * area + kRounding * summed * summed * less;
}

SharedSolid OrderedPair::shared_of(const std::array<InnerSurface, 2>& inner) const {
  SharedSolid shared;
  const auto& [f, g] = inner;
  const SurfaceMoments &m = f.moments, &n = g.moments;
  shared.volume = std::max((m.flux() + n.flux()) / 3, 0.0);
  if (shared.volume == 0) return shared;
  shared.centroid = 0.25 / shared.volume * (m.first + n.first);
  const double v = first_->volume(), w = second_->volume();
  // Each solid's depth counts by the square of its volume: a half-space's alone, twins' by half.
  const double of_second = w * w / (v * v + w * w), of_first = v * v / (v * v + w * w);
  // Both parts say the same but for the closure: their mean is the same for either role.
  shared.area = 0.5 * (m.area - n.area);
  shared.turn = 0.5 * (m.turn() - n.turn()) - cross(shared.centroid, shared.area);
  shared.force = of_second * f.force - of_first * g.force;
  shared.torque = of_second * f.torque - of_first * g.torque - cross(shared.centroid, shared.force);
  return shared;
}

SharedSolid OrderedPair::in_world(SharedSolid shared, const Place& place) {
  if (shared.volume == 0) return shared;
  const double sign = place.is_turned ? -1 : 1;
  const Rotation& to_world = place.first.rotation;
  const auto turn = [&](Vec3& v) { v = sign * (to_world * v); };
  turn(shared.area), turn(shared.turn), turn(shared.force), turn(shared.torque);
  shared.centroid = place.first * shared.centroid;
  for (SharedContact& contact : shared.contacts) {
    turn(contact.area), turn(contact.force), turn(contact.torque);
    contact.centroid = place.first * contact.centroid;
  }
  return shared;
}

// Returns the last contacts of the surfaces, in the first's frame, with torques about a point.
std::vector<SharedContact> SolidPair::contacts(std::uint32_t count, Vec3 about) const {
  std::vector<std::pair<SharedContact, const SurfaceContact*>> all;
  for (const SurfaceContact& contact : surfaces_.contacts()) {
    const SharedSolid s = pair_.shared_of(contact.inner);
    if (s.volume == 0) continue;
    const Vec3 torque = s.torque + cross(s.centroid - about, s.force);
    all.push_back({{s.volume, s.centroid, s.area, s.force, torque, 0, 1}, &contact});
  }
  std::ranges::sort(all, {}, [](const auto& c) {
    const auto& [x, y, z] = c.first.centroid;
    return std::tuple(-c.first.volume, x, y, z);
  });
  std::vector<SharedContact> listed;
  std::vector<const SurfaceContact*> deepest;  // of each in the list
  for (const auto& [contact, sums] : all) {
    if (listed.size() <= count) {
      listed.push_back(contact), deepest.push_back(sums);
    } else {
      add(listed.back(), contact);
      if (sums->deepest[0].depth > deepest.back()->deepest[0].depth) deepest.back() = sums;
    }
  }
  for (std::size_t k = 0; k < listed.size(); ++k)
    listed[k].depth = surfaces_.greatest_depth(*deepest[k]);
  return listed;
}

// Measures with one jitter after the other until the boundary closes, in the first's frame.
SharedSolid SolidPair::closed(const OrderedPair::Place& place, bool with_force,
                              bool with_contacts) {
  double worst = 0;
  for (int attempt = 0; attempt < OrderedPair::kAttempts; ++attempt) {
    const SurfacePairSums found =
        surfaces_.run(pair_.moved(place, attempt), with_force, with_contacts);
    if (pair_.unlikeness() > kMostUnlike && found.crossings + found.whole > 0)
      refuse_unlike(pair_.unlikeness());
    const double gap = pair_.closure(found.inner);
    worst = std::max(worst, gap);
    if (found.undecided > 0 || !(gap <= kMaxClosure)) continue;
    SharedSolid shared = pair_.shared_of(found.inner);
    if (shared.volume <= pair_.volume_of_touch(found.area, place)) shared = {};
    shared.closure = gap, shared.attempts = attempt + 1;
    return shared;
  }
  pair_.refuse_unclosed(worst);
}

SharedSolid SolidPair::measure(const Pose& pose_a, const Pose& pose_b, bool with_force,
                               std::uint32_t contact_count) {
  const OrderedPair::Place place = pair_.place(pose_a, pose_b);
  if (!pair_.may_meet(place)) return {};
  SharedSolid shared = closed(place, with_force, contact_count > 0);
  if (contact_count > 0 && shared.volume > 0)
    shared.contacts = contacts(contact_count, shared.centroid);
  return OrderedPair::in_world(std::move(shared), place);
}

}  // namespace vpm
