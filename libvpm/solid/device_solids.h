// Measures pairs of solids on a device, with the bits of SolidPair.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/solid/device_pairs.h"
#include "libvpm/solid/solid_pair.h"

namespace vpm {

// Two solids of a list, by their places, and the poses that map their meshes to the world.
struct SolidJob {
  std::uint32_t a = 0, b = 0;
  Pose pose_a, pose_b;
};

// Keeps solids on a device. Belongs to one thread at a time.
class DeviceSolids {
 public:
  // Shares the solids. Throws what make_device_pairs() throws.
  DeviceSolids(const Device& device, std::vector<std::shared_ptr<const SolidSurface>> solids);

  // Returns what SolidPair::measure() returns for each job, without force and contacts; nothing
  // where the host must measure: what does not close at the first attempt, lists too much, or is so
  // little that the solids may only touch.
  std::vector<std::optional<SharedSolid>> run(std::span<const SolidJob> jobs);

 private:
  using Answers = std::span<std::optional<SharedSolid>>;
  void run_part(std::span<const SolidJob> jobs, Answers answers);
  const OrderedPair& pair_of(const SolidJob& job);

  std::vector<std::shared_ptr<const SolidSurface>> solids_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, OrderedPair> pairs_;
  std::unique_ptr<DevicePairs> device_;
};

}  // namespace vpm
