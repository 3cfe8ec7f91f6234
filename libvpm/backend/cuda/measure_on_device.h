// Does what all measures on a device share: brings clouds and poses there, waits for the answers.
#pragma once

#include <memory>

#include "libvpm/backend/cuda/answer.h"
#include "libvpm/backend/device_measure.h"
#include "libvpm/device/cuda/occupancy.h"
#include "libvpm/scene/cuda/cloud_slot.h"

namespace vpm::cuda {

class MeasureOnDevice : public DeviceMeasure {
 public:
  // Keeps the tool by reference. The device must be the current one.
  MeasureOnDevice(const ToolModel& tool, int device) : device_(device), tool_(tool) {}

  void run(const SceneView& scene, std::span<DeviceMeasure* const> measures,
           std::span<const Job> jobs, std::span<Result> results) final;
  void read_states(std::vector<SphereState>& states) final;
  double flood_microseconds() const final { return flood_microseconds_; }

 protected:
  // Launches one query, which sends its result to `answer` as number `sequence`, counting up.
  virtual void launch(const Pose& to_surface, Answer* answer, unsigned sequence) = 0;
  // Names the poses of one tool among many: they follow those of the tool before.
  struct ToolPart {
    MeasureOnDevice* measure = nullptr;  // all are of one class
    unsigned end = 0;
  };
  // Launches many queries, from poses and to results on the device, in this measure's stream and
  // cloud.
  virtual void launch(std::span<const ToolPart> tools, const Pose* to_surfaces,
                      RawResult* results) = 0;
  // Returns a word per sphere of query number `sequence`; state_of() says what it means.
  virtual const std::uint32_t* state_words(unsigned sequence) const = 0;
  virtual SphereState state_of(std::uint32_t word) const = 0;

  const DeviceCloud& cloud() const { return *cloud_; }
  cudaStream_t stream() const { return stream_.get(); }

 private:
  // Holds the poses of one launch.
  struct Batch {
    static constexpr std::size_t kPoses = 16384;

    Batch() : poses(kPoses), results(kPoses), answers(kPoses) {}
    DeviceArray<Pose> poses;
    DeviceArray<RawResult> results;
    std::vector<RawResult> answers;
    // For several tools: the poses ordered by tool, and the place from which each comes.
    std::vector<ToolPart> tools;
    std::vector<Pose> ordered;  // maps to the surface's frame
    std::vector<std::uint32_t> places;
  };

  void bring(const PreparedCloud& cloud);
  // Returns null where the frame's cloud is not made on this device.
  const CloudSlot* bring(const DepthFrame& frame);
  Result ask(const Pose& pose);
  // Returns what maps coordinates about the tool's centre of mass to the surface's frame.
  Pose to_surface(const Pose& pose, const Pose& surface_to_world) const;
  void ask(std::span<DeviceMeasure* const> measures, std::span<const Job> jobs,
           std::span<Result> results);
  // Returns the answers to the poses of one launch.
  std::span<const RawResult> answers_of(std::span<const ToolPart> tools,
                                        std::span<const Pose> to_surfaces);
  void order_by_tool(std::span<DeviceMeasure* const> measures, std::span<const Job> jobs);

  int device_;
  const ToolModel& tool_;
  Stream stream_;
  MappedArray<Answer> answer_{1};
  unsigned sequence_ = 0;
  double flood_microseconds_ = 0;
  std::shared_ptr<const DeviceCloud> copy_;  // copy of the last cloud that the host prepared
  std::uint64_t serial_ = 0;
  const CloudSlot* frame_ = nullptr;  // frame of the queries under way, if it is made on the device
  const DeviceCloud* cloud_ = nullptr;  // cloud of the queries under way
  std::unique_ptr<Batch> batch_;
};

std::unique_ptr<DeviceMeasure> make_refined_measure(const ToolModel& tool, const Level& level,
                                                    const QueryOptions& options, int device);

}  // namespace vpm::cuda
