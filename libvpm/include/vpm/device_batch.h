// Poses and answers that stay in the memory of a CUDA device, for programs that compute on it.
//
//   const vpm::DevicePoses poses{numbers, count, 7, stream};        // 7 numbers for each
//   const vpm::DeviceResults answers = query.run(scene, poses);     // returns at once
//   answers.wait_in(stream);       // what follows in the stream sees answers.rows(); <vpm/query.h>
#pragma once

#include <vpm/device.h>
#include <vpm/error.h>
#include <vpm/export.h>
#include <vpm/pose.h>
#include <vpm/query_types.h>

#include <cstddef>
#include <cstdint>
#include <memory>

namespace vpm {

// Poses of the first tool in a device's memory, tool to world coordinates, m. They must stay as
// they are until their answers are there.
struct DevicePoses {
  const double* numbers = nullptr;  // count x width numbers, row by row
  std::size_t count = 0;
  // Numbers of each pose: 7 for tx ty tz qx qy qz qw; 12 or 16 for a matrix of 3 x 4 or 4 x 4, row
  // by row.
  std::uint32_t width = 7;
  // cudaStream_t in which the numbers are ready once its work so far is done; null: that of the
  // default stream.
  void* stream = nullptr;
};

// Answer to one pose of DevicePoses, as Result has it. A pose that Query::run refuses has NaN in
// all its fractions, volumes and vectors, and 0 spheres. What is known of the tool is NaN where
// Result tells nothing.
struct DeviceResult {
  double volume, volume_fraction;
  Vec3 force, torque;
  double seen_free, unseen, out_of_view;
  std::uint32_t boundary, inside;
};

class ResidentAnswers;

// Answers to poses on a device, which it may still be computing. Shares its memory with its copies,
// which the last one gives back once the device has done what it has in hand. Thread-safe.
class VPM_API DeviceResults {
 public:
  std::size_t size() const;
  // Returns the device that holds them, and its memory.
  Device device() const;
  const DeviceResult* rows() const;

  // Makes later work of a stream (cudaStream_t; null: the default stream) wait for the answers.
  // Throws Error(unavailable) if the device fails, as wait() does.
  void wait_in(void* stream) const;
  // Returns when the answers are there.
  void wait() const;

 private:
  friend class Query;
  explicit DeviceResults(std::shared_ptr<const ResidentAnswers> answers);
  const ResidentAnswers& answers() const;

  std::shared_ptr<const ResidentAnswers> answers_;  // null once moved from
};

}  // namespace vpm
