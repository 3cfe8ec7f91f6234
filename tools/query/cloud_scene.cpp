#include "tools/query/cloud_scene.h"

#include <vpm/error.h>

#include <chrono>
#include <utility>

#include "tools/common/error_text.h"
#include "tools/common/remarks.h"
#include "tools/query/registration.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {

namespace {

std::vector<NamedCloud> read_clouds(const std::vector<std::string>& names) {
  std::vector<NamedCloud> clouds;
  for (const std::string& name : names) clouds.push_back({name, PointCloud::read(name)});
  return clouds;
}

void check_cameras(const std::vector<NamedCloud>& clouds) {
  if (clouds.size() < 2) return;
  for (const auto& [name, cloud] : clouds) {
    if (!cloud.camera())
      throw Error(ErrorKind::refused,
                  "several clouds are one body by their cameras, but this one keeps none", name,
                  "give it as the only --cloud, or make it of the depth image by vpm-normals");
  }
}

// Runs `make`. Names the cloud in errors that do not say where they are.
template <class Make>
auto naming_cloud(const std::string& name, const Make& make) {
  try {
    return make();
  } catch (const Error& fault) {
    if (!fault.where().empty()) throw;
    throw Error(fault.kind(), fault.problem(), name, fault.hint());
  }
}

std::vector<Body> bodies_of_clouds(const std::vector<NamedCloud>& clouds, Denoising points) {
  std::vector<Body> bodies;
  for (const auto& [name, cloud] : clouds)
    bodies.push_back(naming_cloud(name, [&] { return Body(cloud, points); }));
  return bodies;
}

// Says what is too thin for how well cameras on its two sides agree.
void say_if_uncertain(const Program& program, const std::vector<Body>& images) {
  if (const std::optional<Remark> remark = uncertain_thickness(images)) say(program, {*remark});
}

// Moves the cameras of clouds until their images agree. One alone, which a request has put in the
// place of others, stays.
void move_to_agree(const QuerySetup& setup, std::vector<NamedCloud>& clouds) {
  if (setup.arguments.clouds.size() < 2)
    refuse_usage("--register makes the images of cameras agree: give several --cloud");
  if (clouds.size() < 2) return;
  std::vector<std::string> names;
  std::vector<Pose> told;
  for (const auto& [name, cloud] : clouds) {
    names.push_back(name);
    told.push_back(cloud.camera()->to_world);
  }
  const std::vector<Body> images = bodies_of_clouds(clouds, setup.points);
  const Registration found = registered(setup.program, names, told, images);
  for (std::size_t k = 0; k < clouds.size(); ++k)
    clouds[k].cloud = clouds[k].cloud.seen_from(found.to_world[k]);
  // Cameras on two sides of a thing may agree with those on their own side alone.
  if (found.observable < found.motions) say_if_uncertain(setup.program, images);
}

}  // namespace

CloudScene::CloudScene(QuerySetup& setup)
    : CloudScene(setup, read_clouds(setup.arguments.clouds)) {}

CloudScene::CloudScene(QuerySetup& setup, std::vector<NamedCloud> clouds) : setup_(setup) {
  check_cameras(clouds);
  if (setup.arguments.registers) move_to_agree(setup, clouds);
  const auto start = std::chrono::steady_clock::now();
  const std::vector<Body> images = bodies_of_clouds(clouds, setup.points);
  std::vector<Body> bodies = images;
  if (images.size() > 1) bodies = {naming("--cloud", [&] { return Body::of_cameras(images); })};
  bodies.insert(bodies.end(), setup.solids.begin(), setup.solids.end());
  scene_.emplace(std::move(bodies));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  prepare_seconds_ = taken.count();
  for (const auto& [name, cloud] : clouds) {
    checks_.emplace_back(setup.tools, cloud, setup.options.measure);
    if (setup.view) setup.view->add_cloud(name, cloud);
  }
  say_at_start(images, clouds);
}

void CloudScene::say_at_start(const std::vector<Body>& images,
                              const std::vector<NamedCloud>& clouds) {
  const auto doubted = images.size() > 1 ? doubted_camera(images) : std::nullopt;
  if (images.size() > 1 && !doubted && !setup_.arguments.registers)
    say_if_uncertain(setup_.program, images);
  const Remarks doubts = doubted ? Remarks{doubted->remark} : remarks();
  if (doubted)
    say(setup_.program, clouds[doubted->camera].name, doubts);
  else
    say(setup_.program, doubts);
  has_said_ = !doubts.empty();
}

Remarks CloudScene::remarks() const {
  Remarks first;
  for (const SetupCheck& check : checks_) {
    const Remarks found = check.remarks();
    if (found.empty()) return {};
    if (first.empty()) first = found;
  }
  return first;
}

void CloudScene::warn_at_end() const {
  if (!has_said_) say(setup_.program, remarks());
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

// True if a pose came with poses of all solids or of none.
bool are_all_or_none(std::size_t given, std::size_t solids) {
  return given == 0 || given == solids;
}

// Throws Error(refused) unless it is so of the last pose.
void check_solids(const PoseReader& reader, std::size_t solids) {
  const std::size_t given = reader.solids().size();
  if (are_all_or_none(given, solids)) return;
  throw Error(ErrorKind::refused, misfit_of_solids(given, solids), reader.place(), kSolidsAdvice);
}

}  // namespace

std::optional<AskedPose> asked_on(const std::string& line, std::size_t solids, PoseParser& parser) {
  std::optional<ToldPose> told = parser.of_plain_line(line);
  if (!told || !are_all_or_none(told->solids.size(), solids)) return std::nullopt;
  return AskedPose{told->pose, std::move(told->id), std::move(told->solids)};
}

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

std::vector<AskedPose> PoseSource::next_together() {
  constexpr std::size_t kMost = 1024;
  if (unread_) std::rethrow_exception(std::exchange(unread_, nullptr));
  std::vector<AskedPose> poses;
  try {
    do {
      std::optional<AskedPose> pose = next_one();
      if (!pose) break;
      poses.push_back(std::move(*pose));
    } while (poses.size() < kMost && reader_ && reader_->has_more());
  } catch (...) {
    if (poses.empty()) throw;
    unread_ = std::current_exception();
  }
  return poses;
}

std::optional<PoseLines> PoseSource::next_lines() {
  if (unread_ || pending_ || !reader_ || !has_lines_) return std::nullopt;
  return reader_->next_lines();
}

void PoseSource::give_back(std::string_view lines) {
  reader_->give_back(lines);
  has_lines_ = false;
}

void PoseSource::pass_over(std::size_t poses) {
  for (std::size_t k = 0; k < poses; ++k)
    if (!next_one()) refuse("there are fewer poses than lines of the run before");
}

double PoseSource::largest_deviation() const {
  return reader_ ? std::max(deviation_, reader_->largest_deviation()) : deviation_;
}

}  // namespace vpm::tools
