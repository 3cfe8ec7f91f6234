#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>

#include "libvpm/api/handle_access.h"
#include "libvpm/api/overlap_answer.h"
#include "libvpm/core/error.h"
#include "libvpm/core/exact_pose.h"
#include "libvpm/core/parallel.h"
#include "libvpm/solid/box_pairs.h"
#include "libvpm/solid/solid_pair.h"

namespace vpm {
namespace {

// Returns the pose of each part, exact. Throws Error(refused) that names the part.
std::vector<Pose> poses_of(std::span<const Part> parts) {
  std::vector<Pose> poses;
  for (const Part& part : parts) try {
      poses.push_back(exact_pose(part.to_world));
    } catch (const Error& error) {
      throw Error(error.kind(), error.problem(), "part " + std::to_string(poses.size()),
                  error.hint());
    }
  return poses;
}

// Returns the box of a solid in the world, with room for what flush faces may have inside of it.
Box box_of(const SolidSurface& surface, const Pose& pose) {
  const Vec3 center = pose * surface.center_of_mass();
  const double far = std::max(norm(center), norm(surface.center_of_mass())),
               room = depth_of_touch(surface.reach(), far);
  Box box;
  for (const Vec3& v : surface.tree().vertices()) box.add(pose.rotation * v + center);
  box.low = box.low - Vec3{room, room, room};
  box.high = box.high + Vec3{room, room, room};
  return box;
}

std::vector<Box> boxes_of(std::span<const Part> parts) {
  const std::vector<Pose> poses = poses_of(parts);
  std::vector<Box> boxes(parts.size());
  parallel_for(parts.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      boxes[k] = box_of(*HandleAccess::shared(parts[k].solid), poses[k]);
  });
  return boxes;
}

// Throws as a query does of the options, and of a part that was made without what forces need.
void check(std::span<const Part> parts, const OverlapOptions& options) {
  if (parts.empty()) return;
  const auto has_depth = [](const Part& part) {
    return HandleAccess::shared(part.solid)->has_depth();
  };
  const auto bare = std::ranges::find_if_not(parts, has_depth);
  const SolidBody& asked = (bare == parts.end() ? parts.front() : *bare).solid;
  const SolidSurface& surface = *HandleAccess::shared(asked);
  OverlapAnswer(surface, surface, options);
}

// Returns what a device tells of each pair; nothing of what the host measures.
std::vector<std::optional<SharedSolid>> told_by_device(std::span<const Part> parts,
                                                       std::span<const BoxPair> pairs,
                                                       const OverlapOptions& options) {
  if (pairs.empty() || !is_for_device(options))
    return std::vector<std::optional<SharedSolid>>(pairs.size());
  std::vector<std::shared_ptr<const SolidSurface>> solids;
  std::map<const SolidSurface*, std::uint32_t> places;  // in that list
  const auto place_of = [&](const Part& part) {
    const auto& solid = HandleAccess::shared(part.solid);
    const auto [at, is_new] =
        places.try_emplace(solid.get(), static_cast<std::uint32_t>(solids.size()));
    if (is_new) solids.push_back(solid);
    return at->second;
  };
  std::vector<SolidJob> jobs;
  for (const auto& [first, second] : pairs)
    jobs.push_back({place_of(parts[first]), place_of(parts[second]),
                    exact_pose(parts[first].to_world), exact_pose(parts[second].to_world)});
  return DeviceSolids(options.device, std::move(solids)).run(jobs);
}

// Returns what the parts of a pair share, as a device told it or as the host measures it.
Overlap overlap_of(const Part& a, const Part& b, const std::optional<SharedSolid>& told,
                   OverlapOptions options) {
  options.device = {};
  if (!told) return overlap(a.solid, a.to_world, b.solid, b.to_world, options);
  return OverlapAnswer(*HandleAccess::shared(a.solid), *HandleAccess::shared(b.solid), options)
      .of(*told);
}

// Returns the pair with what its parts share, or with the reason why that cannot be told; nothing
// if the parts share nothing.
std::optional<OverlappingPair> measured(std::span<const Part> parts, const BoxPair& at,
                                        const OverlapOptions& options,
                                        const std::optional<SharedSolid>& told) {
  try {
    const Overlap shared = overlap_of(parts[at.first], parts[at.second], told, options);
    if (shared.volume == 0) return std::nullopt;
    return OverlappingPair{at.first, at.second, shared, {}};
  } catch (const Error& error) {
    return OverlappingPair{at.first, at.second, {}, error.what()};
  }
}

}  // namespace

std::vector<OverlappingPair> overlapping_pairs(std::span<const Part> parts,
                                               const OverlapOptions& options) {
  check(parts, options);
  const std::vector<BoxPair> near = boxes_that_meet(boxes_of(parts));
  const auto told = told_by_device(parts, near, options);
  std::vector<std::optional<OverlappingPair>> found(near.size());
  parallel_for(near.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) found[k] = measured(parts, near[k], options, told[k]);
  });
  std::vector<OverlappingPair> pairs;
  for (std::optional<OverlappingPair>& pair : found)
    if (pair) pairs.push_back(std::move(*pair));
  return pairs;
}

}  // namespace vpm
