#include "tools/query/cloud_scene.h"

#include <chrono>
#include <utility>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/error.h"
#include "tools/common/error_text.h"

namespace vpm::tools {

CloudScene::CloudScene(QuerySetup& setup) {
  const std::string& name = setup.arguments.cloud;
  const Cloud cloud = read_cloud(name);
  const auto start = std::chrono::steady_clock::now();
  try {
    cloud_.emplace(cloud, setup.points);
  } catch (const Error& fault) {
    if (!fault.where().empty()) throw;
    throw Error(fault.kind(), fault.problem(), name, fault.hint());
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  prepare_seconds_ = taken.count();
  setup_check_.emplace(setup.tool, setup.models, cloud.positions, source_of(cloud),
                       [scene = checked_scene(cloud)](std::size_t) { return scene; });
  if (setup.options.measure == Measure::refined && !setup_check_->doubts_sizes())
    measured_check_.emplace(setup.tool, setup.models, *cloud_);
  if (!cloud.sensor) enclosed_check_.emplace(setup.tool, setup.models, cloud);
  if (setup.view) setup.view->add_cloud(name, cloud);
}

void CloudScene::see(const Pose& pose, std::size_t k, const Result& result) {
  setup_check_->see(pose, k, result);
  if (measured_check_) measured_check_->see(pose, k);
  if (enclosed_check_) enclosed_check_->see(pose, k, result);
}

void CloudScene::warn_at_end() const {
  setup_check_->warn_at_end();
  if (measured_check_) measured_check_->warn_at_end();
  if (enclosed_check_) enclosed_check_->warn_at_end();
}

PoseSource::PoseSource(const Arguments& arguments) : arguments_(arguments) {
  if (!arguments.pose.empty())
    pending_ = naming("--pose", [&] { return pose_from_text(arguments.pose, &deviation_); });
}

Pose PoseSource::first() {
  if (!pending_) pending_ = next_one();
  if (!pending_) reader_->refuse_empty();
  return *pending_;
}

std::optional<Pose> PoseSource::next_one() {
  if (pending_) return std::exchange(pending_, std::nullopt);
  if (!arguments_.pose.empty()) return std::nullopt;
  if (!reader_) reader_.emplace(arguments_.poses);
  return reader_->next();
}

std::vector<Pose> PoseSource::next(std::size_t most) {
  std::vector<Pose> poses;
  while (poses.size() < most) {
    const std::optional<Pose> pose = next_one();
    if (!pose) break;
    poses.push_back(*pose);
  }
  return poses;
}

double PoseSource::largest_deviation() const {
  return reader_ ? reader_->largest_deviation() : deviation_;
}

}  // namespace vpm::tools
