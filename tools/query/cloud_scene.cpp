#include "tools/query/cloud_scene.h"

#include <vpm/error.h>

#include <chrono>
#include <utility>

#include "tools/common/error_text.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {

CloudScene::CloudScene(QuerySetup& setup) : setup_(setup) {
  const std::string& name = setup.arguments.cloud;
  name.empty() ? void(scene_.emplace(setup.solids)) : add(setup, name, PointCloud::read(name));
}

CloudScene::CloudScene(QuerySetup& setup, const std::string& name, const PointCloud& cloud)
    : setup_(setup) {
  add(setup, name, cloud);
}

void CloudScene::add(QuerySetup& setup, const std::string& name, const PointCloud& cloud) {
  const auto start = std::chrono::steady_clock::now();
  try {
    std::vector<Body> bodies{Body(cloud, setup.points)};
    bodies.insert(bodies.end(), setup.solids.begin(), setup.solids.end());
    scene_.emplace(std::move(bodies));
  } catch (const Error& fault) {
    if (!fault.where().empty()) throw;
    throw Error(fault.kind(), fault.problem(), name, fault.hint());
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  prepare_seconds_ = taken.count();
  check_.emplace(setup.tools, cloud, setup.options.measure);
  const Remarks remarks = check_->remarks();
  say(setup.program, remarks);
  has_said_ = !remarks.empty();
  if (setup.view) setup.view->add_cloud(name, cloud);
}

void CloudScene::warn_at_end() const {
  if (check_ && !has_said_) say(setup_.program, check_->remarks());
}

std::vector<Job> jobs_of(const std::vector<AskedPose>& asked) {
  std::vector<Job> jobs;
  for (const AskedPose& one : asked) jobs.push_back({one.pose, 0, one.solids});
  return jobs;
}

PoseSource::PoseSource(const Arguments& arguments) : arguments_(arguments) {
  if (!arguments.pose.empty())
    pending_ = {
        naming("--pose", [&] { return pose_from_text(arguments.pose, &deviation_); }), {}, {}};
}

AskedPose PoseSource::first() {
  if (!pending_) pending_ = next_one();
  if (!pending_) reader_->refuse_empty();
  return *pending_;
}

namespace {

// Throws Error(refused) unless the last pose came with poses of all solids or of none.
void check_solids(const PoseReader& reader, std::size_t solids) {
  const std::size_t given = reader.solids().size();
  if (given == 0 || given == solids) return;
  throw Error(ErrorKind::refused, misfit_of_solids(given, solids), reader.place(), kSolidsAdvice);
}

}  // namespace

std::optional<AskedPose> PoseSource::next_one() {
  if (pending_) return std::exchange(pending_, std::nullopt);
  if (!arguments_.pose.empty()) return std::nullopt;
  if (!reader_) reader_.emplace(arguments_.poses.front());
  const std::optional<Pose> pose = reader_->next();
  if (!pose) return std::nullopt;
  check_solids(*reader_, arguments_.solids.size());
  return AskedPose{*pose, reader_->id(), reader_->solids()};
}

std::vector<AskedPose> PoseSource::next(std::size_t most) {
  std::vector<AskedPose> poses;
  while (poses.size() < most) {
    const std::optional<AskedPose> pose = next_one();
    if (!pose) break;
    poses.push_back(*pose);
  }
  return poses;
}

void PoseSource::pass_over(std::size_t poses) {
  for (std::size_t k = 0; k < poses; ++k)
    if (!next_one()) refuse("there are fewer poses than lines of the run before");
}

double PoseSource::largest_deviation() const {
  return reader_ ? reader_->largest_deviation() : deviation_;
}

}  // namespace vpm::tools
