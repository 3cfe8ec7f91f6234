#include <vpm/query.h>

#include <deque>
#include <memory>
#include <utility>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"

namespace vpm {

struct Query::Impl {
  Impl(std::span<const Tool> handles, const QueryOptions& options)
      : tools(handles.begin(), handles.end()) {
    if (tools.empty()) throw Error(ErrorKind::invalid_argument, "a query needs a tool");
    for (const Tool& tool : tools) queries.emplace_back(HandleAccess::held(tool), options);
    for (ToolQuery& query : queries) pointers.push_back(&query);
  }
  Impl(const Impl& other) : tools(other.tools), queries(other.queries) {
    for (ToolQuery& query : queries) pointers.push_back(&query);
  }

  std::vector<Tool> tools;  // the queries refer to their models
  std::deque<ToolQuery> queries;
  std::vector<ToolQuery*> pointers;
};

Query::Query(const Tool& tool, const QueryOptions& options)
    : Query(std::span<const Tool>(&tool, 1), options) {}
Query::Query(std::span<const Tool> tools, const QueryOptions& options)
    : impl_(std::make_unique<Impl>(tools, options)) {}
Query::Query(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Query::~Query() = default;
Query::Query(Query&&) noexcept = default;
Query& Query::operator=(Query&&) noexcept = default;

Query::Impl& Query::impl() const {
  return held_by(impl_, "Query");
}

Query Query::another() const {
  return Query(std::make_unique<Impl>(impl()));
}

Result Query::run(const Scene& scene, const Pose& pose, std::span<const Pose> solids) {
  return impl().queries.front().run(HandleAccess::held(scene), pose,
                                    {HandleAccess::solids(scene), solids});
}

Collides Query::collides(const Scene& scene, const Pose& pose, double unseen_limit,
                         std::span<const Pose> solids) {
  return impl().queries.front().collides(HandleAccess::held(scene), pose, unseen_limit,
                                         {HandleAccess::solids(scene), solids});
}

void Query::run(const Scene& scene, std::span<const Job> jobs, std::span<Result> results) {
  ToolQuery::run(impl().pointers, HandleAccess::held(scene), jobs, results,
                 HandleAccess::solids(scene));
}

DeviceResults Query::run(const Scene& scene, const DevicePoses& poses) {
  return DeviceResults(
      impl().queries.front().run(HandleAccess::held(scene), poses, HandleAccess::solids(scene)));
}

DeviceResults::DeviceResults(std::shared_ptr<const ResidentAnswers> answers)
    : answers_(std::move(answers)) {}
const ResidentAnswers& DeviceResults::answers() const {
  return held_by(answers_, "DeviceResults");
}
std::size_t DeviceResults::size() const {
  return answers().size();
}
Device DeviceResults::device() const {
  return answers().device();
}
const DeviceResult* DeviceResults::rows() const {
  return answers().rows();
}
void DeviceResults::wait_in(void* stream) const {
  answers().wait_in(stream);
}
void DeviceResults::wait() const {
  answers().wait();
}

void Query::forget() {
  for (ToolQuery& query : impl().queries) query.forget();
}

std::span<const SphereState> Query::states() const {
  return impl().queries.front().states();
}

std::vector<Result> Query::parts() const {
  return impl().queries.front().parts();
}

std::vector<Contact> Query::contacts() const {
  return impl().queries.front().contacts();
}

std::uint32_t Query::level(std::size_t tool) const {
  if (tool >= impl().queries.size())
    throw Error(ErrorKind::invalid_argument, "the query has no tool " + std::to_string(tool));
  return impl().queries[tool].level().sphere_count;
}

}  // namespace vpm
