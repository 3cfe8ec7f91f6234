#include "libvpm/query/solid_query.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"

namespace vpm {
namespace {

// Stores the state of each sphere of a tool at a pose before a solid at a pose.
void note_states(std::span<const Sphere> spheres, const Pose& pose, const SolidSurface& solid,
                 const Pose& at, std::span<SphereState> states) {
  const Pose to_solid = relative_to({at.rotation, at * solid.center_of_mass()}, pose);
  for (std::size_t k = 0; k < states.size(); ++k)
    states[k] = solid.state_of(to_solid * spheres[k].center, spheres[k].radius);
}

// Returns a solid's answer in the tool's axes and units, with the wrench about its centre of mass.
BodySum sum_of(const SharedSolid& shared, const ToolModel& tool, const Pose& pose) {
  BodySum body;
  body.knows_all_space = true;
  body.variance.emplace();
  ToolSum& sum = body.sum;
  sum.volume.add(std::min(shared.volume / tool.volume, 1.0));
  if (sum.volume.value == 0) return body;
  const Vec3 torque = shared.torque_about(pose * tool.center_of_mass);
  const Rotation to_tool = transpose(pose.rotation);
  const Vec3 f = (1 / tool.volume) * (to_tool * shared.force),
             t = (1 / (tool.volume * tool.radius)) * (to_tool * torque);
  sum.force[0].add(f.x), sum.force[1].add(f.y), sum.force[2].add(f.z);
  sum.torque[0].add(t.x), sum.torque[1].add(t.y), sum.torque[2].add(t.z);
  return body;
}

void count_states(std::span<const SphereState> states, BodySum& body) {
  for (const SphereState state : states) {
    body.boundary += state == SphereState::boundary;
    body.inside += state == SphereState::inside;
  }
}

}  // namespace

std::shared_ptr<const SolidSurface> prepared_surface(const ToolModel& tool, bool with_depth) {
  if (tool.surface.triangles.empty())
    refuse("the tool model keeps no surface, by which solids are measured", {},
           "make it again by vpm-graph, without --no-surface");
  return std::make_shared<const SolidSurface>(tool.surface, with_depth);
}

void SolidQuery::prepare() {
  if (!surface_) surface_ = prepared_surface(tool_, true);
}

SolidPair& SolidQuery::pair_with(const PlacedSolid& solid, std::size_t k) {
  prepare();
  if (pairs_.size() <= k) pairs_.resize(k + 1);
  if (!pairs_[k] || pairs_[k]->other != solid.surface)
    pairs_[k].emplace(Pair{solid.surface, SolidPair(surface_, solid.surface)});
  return pairs_[k]->pair;
}

// Returns the contacts, with torques about the tool's centre of mass. Where rounding makes more
// than the tool of what is shared, sum_of() takes it for all of the tool, and so do the contacts.
std::vector<ContactPatch> SolidQuery::patches_of(const SharedSolid& shared, const Pose& pose,
                                                 std::size_t body) const {
  const Vec3 arm = shared.centroid - pose * tool_.center_of_mass;
  const double part = std::min(tool_.volume / shared.volume, 1.0);
  std::vector<ContactPatch> patches;
  for (const SharedContact& c : shared.contacts)
    patches.push_back({body,
                       part * c.volume,
                       c.centroid,
                       c.area,
                       c.depth,
                       {c.force, c.torque + cross(arm, c.force)},
                       c.patches});
  return patches;
}

SolidAnswer SolidQuery::run(const SolidsAt& solids, std::size_t k, const Pose& pose,
                            std::span<SphereState> states, std::uint32_t contacts) {
  const PlacedSolid& solid = solids.solids[k];
  const Pose at = exact_pose(solids.pose(k));
  const SharedSolid shared = pair_with(solid, k).measure(pose, at, true, contacts);
  SolidAnswer answer{sum_of(shared, tool_, pose), shared.closure, {}};
  std::fill(states.begin(), states.end(), SphereState::outside);
  if (answer.body.sum.volume.value == 0) return answer;
  answer.contacts = patches_of(shared, pose, solid.place);
  note_states(tool_.spheres, pose, *solid.surface, at, states);
  count_states(states, answer.body);
  return answer;
}

SolidAnswer SphereQuery::run(const SolidsAt& solids, std::size_t k, const Pose& pose,
                             std::span<SphereState> states) {
  const ToolModel& solid = *solids.solids[k].model;
  const InnerSphereTree all{solid, solid.levels.back()};
  const SharedSolid shared = pair_.measure(tree_, pose, all, exact_pose(solids.pose(k)), states);
  SolidAnswer answer{sum_of(shared, tree_.model, pose), std::nullopt, {}};
  count_states(states, answer.body);
  return answer;
}

}  // namespace vpm
