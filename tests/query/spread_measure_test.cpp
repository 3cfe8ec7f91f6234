// Batches spread over several devices: each pose is answered once, in its place, and a device's
// exception is passed on. These devices are fakes; tests/cuda uses real ones.

#include <gtest/gtest.h>

#include <atomic>

#include "libvpm/backend/device_measure.h"
#include "libvpm/core/error.h"

namespace vpm {
namespace {

// Answers with the pose's depth and the measure's own place among the tools.
class EchoMeasure : public DeviceMeasure {
 public:
  explicit EchoMeasure(std::atomic<std::size_t>& answered, std::uint32_t place = 0)
      : answered_(answered), place_(place) {}

  void run(const AnyBody&, std::span<DeviceMeasure* const> measures, std::span<const BodyJob> jobs,
           std::span<BodySum> sums) override {
    ASSERT_EQ(jobs.size(), sums.size());
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      sums[k].boundary = static_cast<std::uint32_t>(jobs[k].to_body.translation.z);
      sums[k].inside = dynamic_cast<const EchoMeasure&>(*measures[jobs[k].tool]).place_;
    }
    answered_ += jobs.size();
  }
  std::shared_ptr<const ResidentAnswers> begin(std::span<const AnyBody>, const DevicePoses&,
                                               double) override {
    return nullptr;
  }
  void keep_only(std::span<const AnyBody>) override {}
  void read_states(std::vector<SphereState>&) override {}
  double flood_microseconds() const override { return 0; }

 private:
  std::atomic<std::size_t>& answered_;
  std::uint32_t place_;
};

class BrokenMeasure : public DeviceMeasure {
 public:
  void run(const AnyBody&, std::span<DeviceMeasure* const>, std::span<const BodyJob> jobs,
           std::span<BodySum>) override {
    if (jobs.size() > 1) throw Error(ErrorKind::unavailable, "the device fell off the bus");
  }
  std::shared_ptr<const ResidentAnswers> begin(std::span<const AnyBody>, const DevicePoses&,
                                               double) override {
    return nullptr;
  }
  void keep_only(std::span<const AnyBody>) override {}
  void read_states(std::vector<SphereState>&) override {}
  double flood_microseconds() const override { return 0; }
};

TEST(SpreadMeasure, AnswersEveryPoseOnceInItsPlace) {
  const AnyBody cloud{Cloud{}};
  for (const std::size_t devices : {1, 2, 3, 8}) {
    for (const std::size_t count : {0, 1, 511, 512, 513, 5000, 100003}) {
      SCOPED_TRACE(::testing::Message() << devices << " devices, " << count << " poses");
      std::atomic<std::size_t> answered{0};
      std::vector<std::unique_ptr<DeviceMeasure>> measures;
      for (std::size_t k = 0; k < devices; ++k)
        measures.push_back(std::make_unique<EchoMeasure>(answered));
      std::vector<BodyJob> jobs(count);
      for (std::size_t k = 0; k < count; ++k)
        jobs[k].to_body.translation.z = static_cast<double>(k) + 1;
      std::vector<BodySum> results(count);
      SpreadMeasure spread(std::move(measures));
      DeviceMeasure* const all = &spread;
      spread.run(cloud, {&all, 1}, jobs, results);
      EXPECT_EQ(answered, count);
      for (std::size_t k = 0; k < count; ++k) ASSERT_EQ(results[k].boundary, k + 1);
    }
  }
}

TEST(SpreadMeasure, AsksEveryToolForItsPoses) {
  const AnyBody cloud{Cloud{}};
  constexpr std::size_t kTools = 5, kDevices = 3, kPoses = 5000;
  std::atomic<std::size_t> answered{0};
  std::vector<std::unique_ptr<SpreadMeasure>> tools;
  std::vector<DeviceMeasure*> together;
  for (std::size_t t = 0; t < kTools; ++t) {
    std::vector<std::unique_ptr<DeviceMeasure>> measures;
    for (std::size_t k = 0; k < kDevices; ++k)
      measures.push_back(std::make_unique<EchoMeasure>(answered, static_cast<std::uint32_t>(t)));
    tools.push_back(std::make_unique<SpreadMeasure>(std::move(measures)));
    together.push_back(tools.back().get());
  }
  std::vector<BodyJob> poses(kPoses);
  for (std::size_t k = 0; k < kPoses; ++k) {
    poses[k].tool = static_cast<std::uint32_t>(k * k % kTools);
    poses[k].to_body.translation.z = static_cast<double>(k);
  }
  std::vector<BodySum> results(kPoses);
  together.back()->run(cloud, together, poses, results);
  for (std::size_t k = 0; k < kPoses; ++k) {
    ASSERT_EQ(results[k].boundary, k);
    ASSERT_EQ(results[k].inside, poses[k].tool);
  }
}

TEST(SpreadMeasure, ThrowsWhatADeviceThrows) {
  const AnyBody cloud{Cloud{}};
  std::vector<std::unique_ptr<DeviceMeasure>> measures;
  measures.push_back(std::make_unique<BrokenMeasure>());
  measures.push_back(std::make_unique<BrokenMeasure>());
  SpreadMeasure spread(std::move(measures));
  DeviceMeasure* const all = &spread;
  const std::vector<BodyJob> jobs(5000);
  std::vector<BodySum> results(jobs.size());
  EXPECT_THROW(spread.run(cloud, {&all, 1}, jobs, results), Error);
}

}  // namespace
}  // namespace vpm
