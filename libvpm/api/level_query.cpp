#include <vpm/level_query.h>

#include "libvpm/api/handle_access.h"
#include "libvpm/query/level_tool_query.h"

namespace vpm {

struct LevelQuery::Impl {
  Tool tool;  // the query refers to its model
  LevelToolQuery query;
};

LevelQuery::LevelQuery(const Tool& tool, const QueryOptions& options, const LevelRequest& request,
                       const Scene& scene, const Pose& first_pose)
    : impl_(new Impl{tool, LevelToolQuery(HandleAccess::held(tool), options, request,
                                          HandleAccess::held(scene), first_pose)}) {}
LevelQuery::~LevelQuery() = default;
LevelQuery::LevelQuery(LevelQuery&&) noexcept = default;
LevelQuery& LevelQuery::operator=(LevelQuery&&) noexcept = default;

LevelQuery::Impl& LevelQuery::impl() const {
  return held_by(impl_, "LevelQuery");
}

Result LevelQuery::run(const Scene& scene, const Pose& pose) {
  return impl().query.run(HandleAccess::held(scene), pose);
}

std::uint32_t LevelQuery::level() const {
  return impl().query.query().level().sphere_count;
}

double LevelQuery::seconds() const {
  return impl().query.seconds();
}

LevelReason LevelQuery::reason() const {
  return impl().query.reason();
}

std::optional<SceneScale> LevelQuery::scale() const {
  return impl().query.scale();
}

std::span<const SphereState> LevelQuery::states() const {
  return impl().query.query().states();
}

}  // namespace vpm
