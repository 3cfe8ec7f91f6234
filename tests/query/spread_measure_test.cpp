// Batches spread over several devices: each pose is answered once, in its place, and a device's
// exception is passed on. These devices are fakes; tests/cuda uses real ones.

#include "libvpm/query/spread_measure.h"

#include <gtest/gtest.h>

#include <atomic>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

// Answers with the pose's depth.
class EchoMeasure : public DeviceMeasure {
 public:
  explicit EchoMeasure(std::atomic<std::size_t>& answered) : answered_(answered) {}

  Result run(const PreparedCloud&, const Pose& pose) override {
    Result result;
    result.volume = pose.translation.z;
    return result;
  }
  void run(const PreparedCloud& cloud, std::span<const Pose> poses,
           std::span<Result> results) override {
    ASSERT_EQ(poses.size(), results.size());
    for (std::size_t k = 0; k < poses.size(); ++k) results[k] = run(cloud, poses[k]);
    answered_ += poses.size();
  }
  void read_states(std::vector<SphereState>&) override {}
  double flood_microseconds() const override { return 0; }

 private:
  std::atomic<std::size_t>& answered_;
};

// Answers with the tool's index too.
class EchoTool : public EchoMeasure {
 public:
  EchoTool(std::atomic<std::size_t>& answered, double place)
      : EchoMeasure(answered), place_(place) {}
  using EchoMeasure::run;
  Result run(const PreparedCloud& cloud, const Pose& pose) override {
    Result result = EchoMeasure::run(cloud, pose);
    result.volume_fraction = place_;
    return result;
  }

 private:
  double place_;
};

class BrokenMeasure : public DeviceMeasure {
 public:
  Result run(const PreparedCloud&, const Pose&) override { return {}; }
  void run(const PreparedCloud&, std::span<const Pose>, std::span<Result>) override {
    throw Error(ErrorKind::unavailable, "the device fell off the bus");
  }
  void read_states(std::vector<SphereState>&) override {}
  double flood_microseconds() const override { return 0; }
};

TEST(SpreadMeasure, AnswersEveryPoseOnceInItsPlace) {
  const PreparedCloud cloud{Cloud{}};
  for (const std::size_t devices : {1, 2, 3, 8}) {
    for (const std::size_t count : {0, 1, 511, 512, 513, 5000, 100003}) {
      SCOPED_TRACE(::testing::Message() << devices << " devices, " << count << " poses");
      std::atomic<std::size_t> answered{0};
      std::vector<std::unique_ptr<DeviceMeasure>> measures;
      for (std::size_t k = 0; k < devices; ++k)
        measures.push_back(std::make_unique<EchoMeasure>(answered));
      std::vector<Pose> poses(count);
      for (std::size_t k = 0; k < count; ++k) poses[k].translation.z = static_cast<double>(k) + 1;
      std::vector<Result> results(count);
      SpreadMeasure(std::move(measures)).run(cloud, poses, results);
      EXPECT_EQ(answered, count);
      for (std::size_t k = 0; k < count; ++k)
        ASSERT_EQ(results[k].volume, static_cast<double>(k) + 1);
    }
  }
}

TEST(SpreadMeasure, AsksEveryToolForItsPoses) {
  const PreparedCloud cloud{Cloud{}};
  constexpr std::size_t kTools = 5, kDevices = 3, kPoses = 5000;
  std::atomic<std::size_t> answered{0};
  std::vector<std::unique_ptr<SpreadMeasure>> tools;
  std::vector<DeviceMeasure*> together;
  for (std::size_t t = 0; t < kTools; ++t) {
    std::vector<std::unique_ptr<DeviceMeasure>> measures;
    for (std::size_t k = 0; k < kDevices; ++k)
      measures.push_back(std::make_unique<EchoTool>(answered, static_cast<double>(t)));
    tools.push_back(std::make_unique<SpreadMeasure>(std::move(measures)));
    together.push_back(tools.back().get());
  }
  std::vector<ToolPose> poses(kPoses);
  for (std::size_t k = 0; k < kPoses; ++k) {
    poses[k].tool = static_cast<std::uint32_t>(k * k % kTools);
    poses[k].pose.translation.z = static_cast<double>(k);
  }
  std::vector<Result> results(kPoses);
  together.back()->run_together(together, cloud, poses, results);
  for (std::size_t k = 0; k < kPoses; ++k) {
    ASSERT_EQ(results[k].volume, static_cast<double>(k));
    ASSERT_EQ(results[k].volume_fraction, static_cast<double>(poses[k].tool));
  }
}

TEST(SpreadMeasure, ThrowsWhatADeviceThrows) {
  const PreparedCloud cloud{Cloud{}};
  std::vector<std::unique_ptr<DeviceMeasure>> measures;
  measures.push_back(std::make_unique<BrokenMeasure>());
  measures.push_back(std::make_unique<BrokenMeasure>());
  SpreadMeasure spread(std::move(measures));
  const std::vector<Pose> poses(5000);
  std::vector<Result> results(poses.size());
  EXPECT_THROW(spread.run(cloud, poses, results), Error);
}

}  // namespace
}  // namespace vpm
