#include <vpm/level_query.h>

#include <chrono>
#include <cmath>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/query/level_tool_query.h"
#include "libvpm/query/scene_scale.h"

namespace vpm {

SceneScale scene_scale(const Scene& scene, double tool_radius, const std::optional<Vec3>& place) {
  const std::vector<AnyBody>& bodies = HandleAccess::held(scene);
  if (bodies.empty())
    throw Error(ErrorKind::invalid_argument,
                "a scene's scale is that of its points, and it has solids only", {}, "add a cloud");
  if (!(tool_radius > 0) || !std::isfinite(tool_radius))
    throw Error(ErrorKind::invalid_argument, "a tool's radius must be finite and greater than 0");
  return scene_scale(bodies, tool_radius, place);
}

struct LevelQuery::Impl {
  Impl(std::span<const Tool> handles, const QueryOptions& options, const LevelRequest& level,
       const Scene& scene, const Pose& first_pose)
      : tools(handles.begin(), handles.end()), request(level) {
    if (tools.empty()) throw Error(ErrorKind::invalid_argument, "a query needs a tool");
    if ((level.for_scene || level.deadline_seconds) && HandleAccess::held(scene).empty())
      throw Error(ErrorKind::invalid_argument,
                  "a level by scene or deadline is chosen by points, and the scene has solids only",
                  {}, "leave that choice out, or add a cloud");
    for (const Tool& tool : tools) {
      queries.emplace_back(HandleAccess::held(tool), options, level, HandleAccess::held(scene),
                           first_pose);
      together.push_back(&queries.back().query());
      if (!HandleAccess::solids(scene).empty()) together.back()->prepare_surface();
    }
  }

  Impl(const Impl& other) : tools(other.tools), request(other.request), queries(other.queries) {
    for (LevelToolQuery& query : queries) together.push_back(&query.query());
  }

  LevelToolQuery& query_of(std::size_t tool) {
    if (tool >= queries.size())
      throw Error(ErrorKind::invalid_argument, "the query has no tool " + std::to_string(tool));
    return queries[tool];
  }

  std::vector<Tool> tools;  // the queries refer to their models
  LevelRequest request;
  std::deque<LevelToolQuery> queries;
  std::vector<ToolQuery*> together;  // those of jobs, which have no deadline
  double seconds = 0;
};

LevelQuery::LevelQuery(const Tool& tool, const QueryOptions& options, const LevelRequest& request,
                       const Scene& scene, const Pose& first_pose)
    : LevelQuery(std::span(&tool, 1), options, request, scene, first_pose) {}
LevelQuery::LevelQuery(std::span<const Tool> tools, const QueryOptions& options,
                       const LevelRequest& request, const Scene& scene, const Pose& first_pose)
    : impl_(std::make_unique<Impl>(tools, options, request, scene, first_pose)) {}
LevelQuery::LevelQuery(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
LevelQuery::~LevelQuery() = default;
LevelQuery::LevelQuery(LevelQuery&&) noexcept = default;
LevelQuery& LevelQuery::operator=(LevelQuery&&) noexcept = default;

LevelQuery::Impl& LevelQuery::impl() const {
  return held_by(impl_, "LevelQuery");
}

LevelQuery LevelQuery::another() const {
  return LevelQuery(std::make_unique<Impl>(impl()));
}

Result LevelQuery::run(const Scene& scene, const Pose& pose, std::size_t tool,
                       std::span<const Pose> solids) {
  LevelToolQuery& query = impl().query_of(tool);
  const Result result =
      query.run(HandleAccess::held(scene), pose, {HandleAccess::solids(scene), solids});
  impl().seconds = query.seconds();
  return result;
}

Collides LevelQuery::collides(const Scene& scene, const Pose& pose, double unseen_limit,
                              std::size_t tool, std::span<const Pose> solids) {
  ToolQuery& query = impl().query_of(tool).query();
  const auto start = std::chrono::steady_clock::now();
  const Collides found = query.collides(HandleAccess::held(scene), pose, unseen_limit,
                                        {HandleAccess::solids(scene), solids});
  impl().seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return found;
}

void LevelQuery::run(const Scene& scene, std::span<const Job> jobs, std::span<Result> results) {
  if (impl().request.deadline_seconds)
    throw Error(ErrorKind::invalid_argument, "many jobs have no deadline", {},
                "leave `deadline_seconds` out, or ask pose by pose");
  const auto start = std::chrono::steady_clock::now();
  ToolQuery::run(impl().together, HandleAccess::held(scene), jobs, results,
                 HandleAccess::solids(scene));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  impl().seconds = jobs.empty() ? 0 : taken.count() / static_cast<double>(jobs.size());
}

std::uint32_t LevelQuery::level(std::size_t tool) const {
  return impl().query_of(tool).query().level().sphere_count;
}

std::uint32_t LevelQuery::finest_level(std::size_t tool) const {
  return impl().query_of(tool).finest().sphere_count;
}

double LevelQuery::seconds() const {
  return impl().seconds;
}

LevelReason LevelQuery::reason(std::size_t tool) const {
  return impl().query_of(tool).reason();
}

std::optional<SceneScale> LevelQuery::scale(std::size_t tool) const {
  return impl().query_of(tool).scale();
}

std::span<const SphereState> LevelQuery::states(std::size_t tool) const {
  return impl().query_of(tool).query().states();
}

std::vector<Result> LevelQuery::parts(std::size_t tool) const {
  return impl().query_of(tool).query().parts();
}

std::vector<Contact> LevelQuery::contacts(std::size_t tool) const {
  return impl().query_of(tool).query().contacts();
}

}  // namespace vpm
