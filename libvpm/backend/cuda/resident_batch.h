// Answers poses that lie in the device's memory, and leaves the answers there.
#pragma once

#include <vpm/device_batch.h>

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "libvpm/backend/cuda/views.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/core/lengths.h"
#include "libvpm/core/pose.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/measure/body_sum.h"
#include "libvpm/scene/any_body.h"

namespace vpm::cuda {

// Reads the rotation of a pose of `width` numbers (DevicePoses). Returns false for what
// rotation_from_quaternion() or rotation_from_matrix() refuse.
VPM_HD inline bool read_rotation(const double* n, std::uint32_t width, Rotation& rotation) {
  if (width == 7) {
    const Quaternion q{n[3], n[4], n[5], n[6]};
    const double length = length_of(q);
    rotation = rotation_of(q, length);
    return is_unit(length);
  }
  const Rotation given{{n[0], n[1], n[2]}, {n[4], n[5], n[6]}, {n[8], n[9], n[10]}};
  rotation = nearest_rotation(given);
  const bool ends_well = width == 12 || (n[12] == 0 && n[13] == 0 && n[14] == 0 && n[15] == 1);
  return ends_well && is_near_rotation(given);
}

// Reads a pose as a query takes it. Returns false for one that is refused.
VPM_HD inline bool read_pose(const double* numbers, std::uint32_t width, std::size_t k,
                             Pose& pose) {
  const double* const n = numbers + k * width;
  const bool is_rotated = read_rotation(n, width, pose.rotation);
  pose.rotation = exact_rotation(pose.rotation);
  pose.translation = width == 7 ? Vec3{n[0], n[1], n[2]} : Vec3{n[3], n[7], n[11]};
  return is_rotated && is_in_range(pose.translation);
}

// Scales the answers of a tool.
struct ToolScale {
  Vec3 center_of_mass;                           // m
  double volume = 0, radius = 0, stiffness = 1;  // m^3, m, N/m^3
};

namespace {

constexpr unsigned kResidentThreads = 128;

inline LaunchSize size_of(std::size_t count) {
  return {static_cast<unsigned>((count + kResidentThreads - 1) / kResidentThreads),
          kResidentThreads};
}
__device__ inline std::size_t pose_of_thread() {
  return static_cast<std::size_t>(blockIdx.x) * blockDim.x + threadIdx.x;
}

// Takes poses into the frame of a body. One that is refused is asked at the body's place, and its
// answer not told.
__global__ void place_poses(const DevicePoses poses, const Pose body_to_world,
                            const Vec3 center_of_mass, Pose* placed) {
  const std::size_t k = pose_of_thread();
  if (k >= poses.count) return;
  Pose pose;
  if (!read_pose(poses.numbers, poses.width, k, pose)) pose = body_to_world;
  placed[k] = pose_in_body(body_to_world, pose, center_of_mass);
}

// Adds what one body gives to the sums over bodies, which begin with the first.
template <class Surface>
__global__ void add_body(const RawResult* answers, std::size_t count, bool is_first,
                         SceneSum* sums) {
  const std::size_t k = pose_of_thread();
  if (k >= count) return;
  if (is_first) sums[k] = SceneSum();
  sums[k].add(answers[k].sum, answers[k].boundary, answers[k].inside);
  if (TellsSight<Surface>) sums[k].see(answers[k].unseen, answers[k].sum);
  if (TellsUnknown<Surface>) sums[k].know(answers[k].unseen.unseen, answers[k].sum);
}

__global__ void tell(const DevicePoses poses, const ToolScale tool, const SceneSum* sums,
                     DeviceResult* rows) {
  const std::size_t k = pose_of_thread();
  if (k >= poses.count) return;
  constexpr double kNone = NAN;
  constexpr Vec3 kNowhere{kNone, kNone, kNone};
  Pose pose;
  if (!read_pose(poses.numbers, poses.width, k, pose)) {
    rows[k] = {kNone, kNone, kNowhere, kNowhere, kNone, kNone, kNone, 0, 0};
    return;
  }
  const SceneSum& sum = sums[k];
  const double fraction = sum.volume_fraction();
  const Wrench wrench = sum.wrench(tool.volume, tool.radius, pose.rotation, tool.stiffness);
  Visibility sight{kNone, kNone, kNone};
  if (sum.tells_sight()) sight = sum.visibility();
  rows[k] = {tool.volume * fraction, fraction,        wrench.force,
             wrench.torque,          sight.seen_free, sight.unseen,
             sight.out_of_view,      sum.boundary(),  sum.inside()};
}

}  // namespace

// Throws Error(invalid_argument) unless poses lie in the memory of a device.
inline void require_memory_of(int device, const DevicePoses& poses) {
  if (poses.count == 0) return;
  cudaPointerAttributes place{};
  const bool is_known = cudaPointerGetAttributes(&place, poses.numbers) == cudaSuccess;
  if (!is_known) cudaGetLastError();  // clears it
  const bool is_of_device = place.type == cudaMemoryTypeDevice && place.device == device;
  if (!is_known || (!is_of_device && place.type != cudaMemoryTypeManaged))
    throw Error(ErrorKind::invalid_argument,
                "the poses do not lie in the memory of CUDA device " + std::to_string(device), {},
                "copy them there, or ask a query on their device");
}

// Holds the answers, and the event after which they are there.
class AnswersOnDevice : public ResidentAnswers {
 public:
  // The device must be the current one. Holds the bodies as long as they are asked.
  AnswersOnDevice(int device, std::size_t count, std::span<const AnyBody> bodies)
      : device_(device),
        bodies_(bodies.begin(), bodies.end()),
        rows_(count),
        told_(cudaEventDisableTiming) {}
  ~AnswersOnDevice() override {
    const CurrentDevice current(device_);
    rows_ = {};  // waits for the device
  }

  std::size_t size() const override { return rows_.size(); }
  Device device() const override { return {Device::Kind::cuda, device_}; }
  const DeviceResult* rows() const override { return rows_.get(); }
  void wait_in(void* stream) const override {
    const CurrentDevice current(device_);
    check(cudaStreamWaitEvent(static_cast<cudaStream_t>(stream), told_.get()));
  }
  void wait() const override {
    const CurrentDevice current(device_);
    check(cudaEventSynchronize(told_.get()));
  }

  DeviceResult* memory() { return rows_.get(); }
  const Event& told() const { return told_; }

 private:
  int device_;
  std::vector<AnyBody> bodies_;
  DeviceArray<DeviceResult> rows_;
  Event told_;
};

}  // namespace vpm::cuda
