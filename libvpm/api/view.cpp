#include <vpm/view.h>

#include <utility>

#include "libvpm/api/handle_access.h"
#include "libvpm/cloud/cloud.h"
#include "libvpm/core/handle.h"
#include "libvpm/scene/any_body.h"
#include "libvpm/view/pose_view.h"

namespace vpm {
namespace {

[[noreturn]] void reject(const std::string& what) {
  throw Error(ErrorKind::invalid_argument, what);
}

// Returns the image of a body, as queries see it.
Cloud cloud_of(const DepthBody& body) {
  const PreparedImage& image = body.prepared();
  const DepthSurface surface = image.surface();
  const Camera& camera = image.camera();
  Cloud cloud;
  cloud.origin = image.origin();
  cloud.sensor = CloudSensor{camera, {camera.width, camera.height, {}}};
  for (std::int32_t v = 0; v < surface.height; ++v) {
    for (std::int32_t u = 0; u < surface.width; ++u) {
      const double inverse = surface.measured_at(u, v);
      // What is not measured keeps its sign, by which removed pixels are known.
      cloud.sensor->depth.depth.push_back(static_cast<float>(inverse > 0 ? 1 / inverse : inverse));
    }
  }
  return cloud;
}

// Returns what a body that is no solid shows: a cloud for each camera.
std::vector<Cloud> clouds_of(const AnyBody& body) {
  if (const auto* image = body.as<DepthBody>()) return {cloud_of(*image)};
  std::vector<Cloud> clouds;
  if (const auto* rig = body.as<RigBody>()) {
    for (const DepthBody& image : rig->prepared().images()) clouds.push_back(cloud_of(image));
    return clouds;
  }
  Cloud& points = clouds.emplace_back();
  points.origin = body.origin();
  points.positions = body.positions();
  points.normals = body.normals();
  return clouds;
}

// Adds what a query tells of its last pose.
void add_answer(view::PoseView& view, const Job& job, const Result& result,
                std::span<const SphereState> states, std::vector<Contact> contacts,
                std::uint32_t level) {
  view::PoseView::Answer answer{job.pose, result, {}, std::move(contacts)};
  for (const SphereState state : states) answer.states.push_back(static_cast<std::uint8_t>(state));
  view.add(job, std::move(answer), level);
}

// Adds steps, of which `ask` answers and adds the job of one tool.
template <class Ask>
void add_steps(view::PoseView& view, std::span<const Job> jobs, const Ask& ask) {
  for (std::size_t k = 0; k < jobs.size(); ++k) {
    if (view.can_pass_over() && k + 1 < jobs.size()) {
      view.pass_over();
      continue;
    }
    Job job = jobs[k];
    for (job.tool = 0; job.tool < view.tools(); ++job.tool) ask(job);
  }
}

}  // namespace

View::View(std::span<const Tool> tools, std::vector<std::string> names, const QueryOptions& options,
           const std::string& program)
    : impl_(std::make_unique<view::PoseView>(tools, std::move(names), options, program)) {}
View::~View() = default;
View::View(View&&) noexcept = default;
View& View::operator=(View&&) noexcept = default;

view::PoseView& View::impl() const {
  return held_by(impl_, "View");
}

void View::add_cloud(const std::string& name, const PointCloud& cloud) {
  impl().add_cloud(name, cloud);
}

void View::add_solid(const std::string& name, const Body& solid) {
  if (!solid.is_solid()) reject("a body that is no solid was added as one");
  impl().add_solid(name, solid);
}

void View::add_scene(const Scene& scene, std::span<const std::string> names) {
  const std::vector<Body>& bodies = scene.bodies();
  if (!names.empty() && names.size() != bodies.size())
    reject(std::to_string(names.size()) + " names, but " + std::to_string(bodies.size()) +
           " bodies");
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    const std::string name = names.empty() ? "body " + std::to_string(k) : names[k];
    if (bodies[k].is_solid()) {
      impl().add_solid(name, bodies[k]);
      continue;
    }
    std::vector<Cloud> clouds = clouds_of(HandleAccess::held(bodies[k]));
    for (std::size_t camera = 0; camera < clouds.size(); ++camera) {
      const std::string of = clouds.size() > 1 ? "camera " + std::to_string(camera) + " of " : "";
      impl().add_cloud(of + name, HandleAccess::make<PointCloud>(std::move(clouds[camera])));
    }
  }
}

void View::set_frames(const std::string& name, std::function<PointCloud(std::size_t)> frame) {
  impl().set_frames({view::shown_name(name)}, [frame = std::move(frame)](std::size_t number) {
    return view::PoseView::Images{frame(number)};
  });
}

void View::see_frame(std::optional<std::size_t> frame) {
  impl().see_frame(frame);
}

void View::add(const Job& job, const Result& result, const Query& query) {
  if (job.tool != 0 || impl().tools() != 1) reject("a Query tells of its first tool only");
  add_answer(impl(), job, result, query.states(), query.contacts(), query.level());
}

void View::add(const Job& job, const Result& result, const LevelQuery& query) {
  if (job.tool >= impl().tools()) reject("the view has no tool " + std::to_string(job.tool));
  add_answer(impl(), job, result, query.states(job.tool), query.contacts(job.tool),
             query.level(job.tool));
}

void View::add_batch(Query& query, const Scene& scene, std::span<const Job> jobs) {
  add_steps(impl(), jobs,
            [&](const Job& job) { add(job, query.run(scene, job.pose, job.solids), query); });
}

void View::add_batch(LevelQuery& query, const Scene& scene, std::span<const Job> jobs) {
  add_steps(impl(), jobs, [&](const Job& job) {
    add(job, query.run(scene, job.pose, job.tool, job.solids), query);
  });
}

std::string View::html() const {
  return impl().page().html();
}

void View::write(const std::string& path) const {
  impl().page().write(path);
}

}  // namespace vpm
