// Measures pairs of surfaces on a CUDA device: the sums of SurfacePair without force, in its bits.
#pragma once

#include <vpm/device.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libvpm/solid/surface_view.h"

namespace vpm {

// Two surfaces of a list, by their places, and the pose that maps the second's frame to the
// first's.
struct SurfaceJob {
  std::uint32_t first = 0, second = 0;
  Pose pose;
};

// Sums of a pair at a pose, in the pair's unit: crossed triangles in the first's frame, what is
// inside as a whole in each surface's own.
struct PairAnswer {
  static constexpr unsigned kNumbers = 15, kSums = 4 * kNumbers;

  SurfaceMoments cut[2], whole[2];
  std::uint32_t undecided = 0;  // as SurfacePairSums::undecided
  std::uint32_t has_room = 0;   // 0: a list was too short, and nothing above holds
};

// Keeps surfaces on a device. Belongs to one thread at a time.
class DevicePairs {
 public:
  virtual ~DevicePairs() = default;

  // Stores the sums of each job. There is no room for a pose that lists very much. A single job
  // takes one launch and no copy. Throws Error(unavailable) if the device fails.
  virtual void run(std::span<const SurfaceJob> jobs, std::span<PairAnswer> answers) = 0;
};

// Copies surfaces to a device; Device::kAll is the first. Throws Error(unavailable) in builds
// without CUDA, or if the device has too little memory.
std::unique_ptr<DevicePairs> make_device_pairs(const Device& device,
                                               std::span<const SurfaceView> surfaces);

}  // namespace vpm
