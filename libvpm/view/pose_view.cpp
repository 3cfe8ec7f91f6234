#include "libvpm/view/pose_view.h"

#include <algorithm>
#include <array>
#include <set>

#include "libvpm/api/handle_access.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/view/pose_path.h"

namespace vpm::view {
namespace {

// Most bytes of states that a page holds, and the limits of the number of its steps.
constexpr std::size_t kStateBytes = 1'300'000, kFewestSteps = 50, kMostSteps = 1000;
// Most images of a recording that a page holds, and the most pixels of all of them.
constexpr std::size_t kMostFrames = 24, kFramePixels = 1'000'000;
// State of a sphere that the level of a step does not have.
constexpr std::uint8_t kUnused = 3;

constexpr std::array<const char*, 4> kToolColors{"#b08d57", "#6b8e23", "#8968a8", "#4f8a8b"};
constexpr const char *kForceColor = "#009e73", *kTorqueColor = "#aa4499", *kPathColor = "#0072b2",
                     *kContactColor = "#d55e00";

std::string maker_of(const nlohmann::json& provenance) {
  if (!provenance.is_object()) return "";
  const auto text = [&](const char* key) {
    return provenance.contains(key) && provenance.at(key).is_string()
               ? provenance.at(key).get<std::string>()
               : std::string();
  };
  const std::string tool = text("tool");
  return tool.empty() ? "" : " (" + tool + " " + text("version") + ")";
}

bool sees(const Camera& camera, Vec3 world) {
  const Vec3 at = relative_to(camera.to_world, Pose{{}, world}).translation;
  if (!(at.z > 0)) return false;
  const Intrinsics& k = camera.intrinsics;
  const double u = k.fx * at.x / at.z + k.cx, v = k.fy * at.y / at.z + k.cy;
  return u >= -0.5 && v >= -0.5 && u < camera.width - 0.5 && v < camera.height - 0.5;
}

Vec3 image_up(const Camera& camera) {
  return camera.to_world.rotation * Vec3{0, -1, 0};
}

// Returns the image of a cloud that has one. The cloud must outlive it.
ImageView image_of(const PointCloud& cloud) {
  const CloudSensor& sensor = *HandleAccess::held(cloud).sensor;
  return {&sensor.depth, sensor.camera};
}

}  // namespace

PoseView::PoseView(std::span<const Tool> tools, std::vector<std::string> names,
                   const QueryOptions& options, std::string program)
    : program_(std::move(program)),
      tools_(tools.begin(), tools.end()),
      names_(std::move(names)),
      options_(options),
      levels_(tools.size(), 0) {
  check_available();
  if (tools_.empty() || names_.size() != tools_.size())
    throw Error(ErrorKind::invalid_argument, "a view needs a tool, and a name for each");
  for (std::string& name : names_) name = shown_name(name);
  std::size_t row = 0;
  for (std::size_t t = 0; t < tools_.size(); ++t) {
    meshes_.push_back(model_of(t).surface);
    row += model_of(t).spheres.size() / 4 + 1;
  }
  most_steps_ = std::clamp(kStateBytes / row, kFewestSteps, kMostSteps);
}

const ToolModel& PoseView::model_of(std::size_t tool) const {
  return HandleAccess::held(tools_[tool]);
}

void PoseView::add_cloud(const std::string& name, const PointCloud& cloud) {
  clouds_.emplace_back(shown_name(name), cloud);
}

void PoseView::set_frames(std::vector<std::string> names, Frames frames) {
  cameras_ = std::move(names);
  frames_ = std::move(frames);
}

void PoseView::add(const Job& job, Answer answer, std::uint32_t level) {
  levels_[job.tool] = std::max(levels_[job.tool], level);
  if (job.tool == 0) current_ = {seen_, frame_, {job.solids.begin(), job.solids.end()}, {}};
  current_.answers.push_back(std::move(answer));
  if (job.tool + 1 == tools_.size()) keep(std::move(current_));
}

// Adds a step if its turn has come. Drops every second of those that were kept if there are too
// many.
void PoseView::keep(Step step) {
  const bool is_kept = keeps_next();
  ++seen_;
  last_ = step;
  if (!is_kept) return;
  steps_.push_back(std::move(step));
  if (steps_.size() <= most_steps_) return;
  every_ *= 2;
  std::erase_if(steps_, [&](const Step& s) { return s.index % every_ != 0; });
}

std::vector<PoseView::Step> PoseView::kept() const {
  std::vector<Step> steps = steps_;
  if (!steps.empty() && last_.index > steps.back().index) steps.push_back(last_);
  return steps;
}

void PoseView::add_facts(Page& page) const {
  std::string summary = options_.measure == Measure::paper ? "paper" : "refined";
  for (std::size_t t = 0; t < tools_.size(); ++t) {
    page.add_fact("tool", names_[t] + maker_of(model_of(t).provenance.json()));
    if (levels_[t] == 0) continue;
    const std::string level = std::to_string(levels_[t]) + " of " +
                              std::to_string(model_of(t).spheres.size()) + " spheres";
    page.add_fact("level", level);
    summary += ", " + level;
  }
  page.set_summary(summary);
  for (const auto& [name, cloud] : clouds_)
    page.add_fact("cloud", name + maker_of(HandleAccess::held(cloud).provenance.json()));
  for (const std::string& name : solids_.names()) page.add_fact("solid", name);
  for (const std::string& name : cameras_) page.add_fact("frames", name);
  page.add_fact("measure", options_.measure == Measure::paper ? "paper" : "refined");
  if (options_.shadows == Shadows::solid) page.add_fact("shadows", "solid");
  if (options_.stiffness != 1) page.add_fact("stiffness", with_unit(options_.stiffness, "N/m³"));
  if (every_ > 1)
    page.add_fact("poses", "one in " + std::to_string(every_) + " of " + std::to_string(seen_));
}

PoseView::Cameras PoseView::add_scene(Page& page, const std::vector<Step>& steps) const {
  for (const auto& [name, handle] : clouds_) {
    const std::string of = clouds_.size() > 1 ? " of " + name : "";
    if (handle.camera()) {
      const ImageView image = image_of(handle);
      page.add_image("measured surface" + of, {&image, 1}, {});
    } else {
      page.add_points("measured points" + of, HandleAccess::held(handle));
    }
  }
  std::vector<std::vector<Pose>> poses_of_solids;
  for (const Step& step : steps) poses_of_solids.push_back(step.solids);
  solids_.add_to(page, poses_of_solids);
  return frames_ ? add_frames(page, steps) : Cameras();
}

// Reads the frames that the steps saw again, as many as a page holds, and adds them, a layer for
// each camera.
PoseView::Cameras PoseView::add_frames(Page& page, const std::vector<Step>& steps) const {
  std::set<std::size_t> seen;
  for (const Step& step : steps)
    if (step.frame) seen.insert(*step.frame);
  std::vector<std::size_t> frames(seen.begin(), seen.end());
  const std::size_t every = (frames.size() + kMostFrames - 1) / kMostFrames;
  std::vector<std::size_t> shown;
  std::vector<Images> clouds;  // of each frame, of each camera
  std::size_t pixels = 0;
  for (std::size_t k = 0; k < frames.size(); k += every) {
    shown.push_back(frames[k]);
    for (const std::optional<PointCloud>& cloud : clouds.emplace_back(frames_(frames[k]))) {
      if (cloud && !cloud->camera()) {
        page.add_points("measured points", HandleAccess::held(*cloud));
        page.add_note("The frames are clouds without a camera: the first one is shown.");
        return {};
      }
      if (cloud) pixels += image_of(*cloud).depth->depth.size();
    }
  }
  if (clouds.empty()) return {};
  std::vector<std::optional<std::size_t>> of_step;  // indices of `shown`; none before the first
  Cameras cameras(steps.size());
  for (std::size_t k = 0; k < steps.size(); ++k) {
    of_step.emplace_back();
    if (!steps[k].frame) continue;
    const auto after = std::ranges::upper_bound(shown, *steps[k].frame);
    of_step.back() = static_cast<std::size_t>(after - shown.begin() - 1);
    for (const std::optional<PointCloud>& cloud : clouds[*of_step.back()])
      if (cloud) cameras[k].push_back(*cloud->camera());
  }
  std::uint32_t stride = 1;
  while (pixels / stride / stride > kFramePixels) ++stride;
  for (std::size_t camera = 0; camera < cameras_.size(); ++camera)
    add_camera(page, camera, clouds, of_step, stride);
  if (every > 1)
    page.add_fact("frames shown",
                  std::to_string(shown.size()) + " of " + std::to_string(frames.size()));
  return cameras;
}

// Adds the images of one camera among those of frames. `of_step` says which frame each step sees.
void PoseView::add_camera(Page& page, std::size_t camera, std::span<const Images> frames,
                          std::span<const std::optional<std::size_t>> of_step,
                          std::uint32_t stride) const {
  std::vector<ImageView> images;
  std::vector<std::uint32_t> of_frame, numbers;
  for (const Images& frame : frames) {
    of_frame.push_back(frame[camera] ? static_cast<std::uint32_t>(images.size()) : kNoImage);
    if (frame[camera]) images.push_back(image_of(*frame[camera]));
  }
  if (images.empty()) return;
  for (const std::optional<std::size_t>& frame : of_step)
    numbers.push_back(frame ? of_frame[*frame] : kNoImage);
  const std::string of = cameras_.size() > 1 ? " of " + cameras_[camera] : "";
  page.add_image("measured surface" + of, images, numbers, false, stride);
}

namespace {

// Adds what the camera knows of a tool, if the answers of all steps tell it.
void add_visibility(Page& page, std::span<const Result> answers, std::size_t body) {
  const auto tells = [](const Result& r) { return r.visibility.has_value(); };
  if (!std::ranges::all_of(answers, tells)) return;
  const auto add = [&](const char* name, double Visibility::*part) {
    Column column{name, "%", 1, {}, body};
    for (const Result& r : answers)
      column.values.push_back(static_cast<float>(100 * (*r.visibility).*part));
    page.add_column(column);
  };
  add("seen free", &Visibility::seen_free);
  add("unseen", &Visibility::unseen);
  add("out of view", &Visibility::out_of_view);
}

}  // namespace

std::size_t PoseView::add_numbers(Page& page, const std::vector<Step>& steps, std::size_t tool,
                                  std::size_t body) const {
  const bool has_stiffness = options_.stiffness != 1;
  Column volume{"volume", "m3", 1, {}, body}, fraction{"of the tool", "%", 1, {}, body},
      force{has_stiffness ? "force" : "force / stiffness", has_stiffness ? "N" : "m3", 3, {}, body},
      torque{has_stiffness ? "torque" : "torque / stiffness",
             has_stiffness ? "Nm" : "m4",
             3,
             {},
             body},
      boundary{"boundary spheres", "", 1, {}, body}, inside{"inside spheres", "", 1, {}, body},
      points{"points in spheres", "", 1, {}, body};
  const auto add = [](Column& column, std::initializer_list<double> values) {
    for (const double x : values) column.values.push_back(static_cast<float>(x));
  };
  std::vector<Result> answers;
  for (const Step& step : steps) answers.push_back(step.answers[tool].result);
  for (const Result& r : answers) {
    add(volume, {r.volume});
    add(fraction, {100 * r.volume_fraction});
    add(force, {r.wrench.force.x, r.wrench.force.y, r.wrench.force.z});
    add(torque, {r.wrench.torque.x, r.wrench.torque.y, r.wrench.torque.z});
    add(boundary, {1.0 * r.boundary});
    add(inside, {1.0 * r.inside});
    if (r.points) add(points, {1.0 * *r.points});
  }
  const std::size_t volume_column = page.add_column(volume);
  page.add_column(fraction);
  add_visibility(page, answers, body);
  const std::size_t force_column = page.add_column(force);
  const std::size_t torque_column = page.add_column(torque);
  page.add_column(boundary);
  page.add_column(inside);
  if (points.values.size() == steps.size()) page.add_column(points);
  const std::string of = tools_.size() > 1 ? " of " + names_[tool] : "";
  page.add_arrow("force" + of, kForceColor, body, force_column, false);
  page.add_arrow("torque" + of, kTorqueColor, body, torque_column, true);
  return volume_column;
}

// Adds the contacts of each step: their number, and a line from each centroid against the normal,
// as long as the contact is deep.
void PoseView::add_contacts(Page& page, const std::vector<Step>& steps, std::size_t tool,
                            std::size_t body) const {
  Column numbers{"contacts", "", 1, {}, body};
  const std::string of = tools_.size() > 1 ? " of " + names_[tool] : "";
  for (std::size_t k = 0; k < steps.size(); ++k) {
    const std::vector<Contact>& contacts = steps[k].answers[tool].contacts;
    numbers.values.push_back(static_cast<float>(contacts.size()));
    if (contacts.empty()) continue;
    LinesView lines{.name = "contacts" + of, .color = kContactColor, .ends = {}};
    for (const Contact& c : contacts)
      lines.ends.insert(lines.ends.end(), {c.centroid, c.centroid - c.depth * c.normal});
    lines.count = contacts.size(), lines.marks = lines.above = true, lines.step = k;
    page.add_lines(lines);
  }
  page.add_column(numbers);
}

// True if the poses follow each other: as steps in time do, and others by where they lie.
bool PoseView::are_path(const std::vector<Step>& steps) const {
  if (frames_ || options_.coherent) return true;
  std::vector<Vec3> places;
  for (const Step& step : steps)
    places.push_back(step.answers[0].pose * model_of(0).center_of_mass);
  return is_path(places);
}

std::size_t PoseView::add_tool(Page& page, const std::vector<Step>& steps, std::size_t tool,
                               bool is_joined) const {
  const ToolModel& model = model_of(tool);
  std::vector<Pose> poses;
  std::vector<std::uint8_t> bits;
  for (const Step& step : steps) {
    poses.push_back(step.answers[tool].pose);
    std::vector<std::uint8_t> states = step.answers[tool].states;
    states.resize(levels_[tool], kUnused);
    append_bits(states, bits);
  }
  const std::size_t body = page.add_body(names_[tool], model.center_of_mass, model.radius, poses);
  const std::string of = tools_.size() > 1 ? " of " + names_[tool] : "";
  if (levels_[tool] > 0)
    page.add_spheres({.name = "spheres by state" + of,
                      .spheres = {model.spheres.data(), levels_[tool]},
                      .body = body,
                      .states = bits});
  if (!meshes_[tool].triangles.empty()) {
    page.add_mesh({.name = "tool's mesh" + of,
                   .color = kToolColors[tool % kToolColors.size()],
                   .solid = &meshes_[tool],
                   .body = body,
                   .opacity = 0.3});
  }
  if (steps.size() > 1)
    page.add_path((is_joined ? "path of the tool" : "poses of the tool") + of, kPathColor, body,
                  is_joined);
  const std::size_t volume = add_numbers(page, steps, tool, body);
  if (options_.contacts > 0) add_contacts(page, steps, tool, body);
  return volume;
}

// Adds notes on a tool that no camera sees, and on poses at which nothing is touched.
void PoseView::say_what_is_odd(Page& page, const std::vector<Step>& steps,
                               const Cameras& frame_cameras) const {
  bool has_camera = !frame_cameras.empty(), is_seen = false, touches = false;
  for (const auto& [name, cloud] : clouds_) has_camera = has_camera || cloud.camera();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    for (std::size_t t = 0; t < tools_.size(); ++t) {
      const Answer& answer = steps[k].answers[t];
      const Vec3 center = answer.pose * model_of(t).center_of_mass;
      touches = touches || answer.result.volume > 0;
      if (!frame_cameras.empty())
        is_seen = is_seen || std::ranges::any_of(frame_cameras[k], [&](const Camera& camera) {
                    return sees(camera, center);
                  });
      for (const auto& [name, cloud] : clouds_)
        is_seen = is_seen || (cloud.camera() && sees(*cloud.camera(), center));
    }
  }
  if (has_camera && !is_seen)
    page.add_note(
        "No camera sees the tool's centre at any pose. Poses map the tool to the world (x right, "
        "y down, z forward from a camera whose pose was not given): is one of them inverted, or in "
        "millimetres?");
  if (!touches) page.add_note("The tool touches nothing at any pose: the volume is 0 everywhere.");
}

// Names the tools and what they are in.
std::string PoseView::title() const {
  std::string title = names_[0];
  for (std::size_t t = 1; t < names_.size(); ++t) title += ", " + names_[t];
  std::vector<std::string> scene;
  for (const auto& [name, cloud] : clouds_) scene.push_back(name);
  for (const std::string& name : cameras_) scene.push_back(name);
  for (const std::string& name : solids_.names()) scene.push_back(name);
  return scene.empty() ? title : title + " in " + file::listed(scene);
}

Page PoseView::page() const {
  const std::vector<Step> steps = kept();
  if (steps.empty()) refuse("there is no pose to show", "the page");
  Page page(program_, title());
  page.set_origin(clouds_.empty() ? steps.front().answers[0].pose.translation
                                  : HandleAccess::held(clouds_.front().second).origin);
  for (const auto& [name, cloud] : clouds_)
    if (cloud.camera()) page.set_up(image_up(*cloud.camera()));
  add_facts(page);
  Json volumes = Json::array();
  const bool is_joined = are_path(steps);
  for (std::size_t t = 0; t < tools_.size(); ++t)
    volumes.push_back(add_tool(page, steps, t, is_joined));
  const Cameras frame_cameras = add_scene(page, steps);
  const auto first =
      std::ranges::find_if(frame_cameras, [](const auto& now) { return !now.empty(); });
  if (first != frame_cameras.end()) page.set_up(image_up(first->front()));
  say_what_is_odd(page, steps, frame_cameras);

  std::vector<std::uint32_t> numbers;
  std::size_t deepest = 0;
  double most = 0;  // of the sums of the tools' volumes, m^3
  for (std::size_t k = 0; k < steps.size(); ++k) {
    numbers.push_back(static_cast<std::uint32_t>(steps[k].index));
    double sum = 0;
    for (const Answer& answer : steps[k].answers) sum += answer.result.volume;
    if (sum > most) most = sum, deepest = k;
  }
  page.steps() = {
      {"name", "pose"},    {"count", steps.size()},
      {"start", deepest},  {"moves", true},
      {"last", seen_ - 1}, {"numbers", packed(std::span<const std::uint32_t>(numbers))}};
  if (steps.size() > 1)
    page.add_chart({{"type", "curve"},
                    {"title", is_joined ? "Volume along the path" : "Volume at each pose"},
                    {"x", "pose"},
                    {"y", "volume"},
                    {"every", every_},
                    {"columns", volumes},
                    {"names", names_}});
  const bool has_images = frames_ || !clouds_.empty();
  page.set_views(has_images
                     ? std::vector<std::string>{"overview", "camera", "side", "contact", "all"}
                     : std::vector<std::string>{"overview", "side", "contact", "all"});
  return page;
}

}  // namespace vpm::view
