#include "libvpm/include/vpm/level_query.h"

#include "libvpm/query/level_tool_query.h"

namespace vpm {

struct LevelQuery::Impl {
  Tool tool;  // the query refers to its model
  LevelToolQuery query;
};

LevelQuery::LevelQuery(const Tool& tool, const QueryOptions& options, const LevelRequest& request,
                       const Scene& scene, const Pose& first_pose)
    : impl_(new Impl{tool,
                     LevelToolQuery(tool.model(), options, request, scene.list(), first_pose)}) {}
LevelQuery::~LevelQuery() = default;
LevelQuery::LevelQuery(LevelQuery&&) noexcept = default;
LevelQuery& LevelQuery::operator=(LevelQuery&&) noexcept = default;

Result LevelQuery::run(const Scene& scene, const Pose& pose) {
  return impl_->query.run(scene.list(), pose);
}

std::uint32_t LevelQuery::level() const {
  return impl_->query.query().level().sphere_count;
}

double LevelQuery::seconds() const {
  return impl_->query.seconds();
}

std::string LevelQuery::reason() const {
  return impl_->query.reason();
}

std::optional<SceneScale> LevelQuery::scale() const {
  return impl_->query.scale();
}

std::span<const SphereState> LevelQuery::states() const {
  return impl_->query.query().states();
}

}  // namespace vpm
