#include "tools/query/several_tools.h"

#include <chrono>

#include "tools/query/pose_batches.h"
#include "tools/query/query_report.h"

namespace vpm::tools {

SeveralTools::SeveralTools(std::span<const ToolModel> models, const QueryOptions& options,
                           const LevelRequest& request, const PreparedCloud& cloud,
                           const Pose& first_pose)
    : cloud_(cloud), measure_(options.measure) {
  for (const ToolModel& model : models) {
    queries_.emplace_back(model, options, request, cloud, first_pose);
    together_.push_back(&queries_.back().query());
  }
}

void SeveralTools::run(std::optional<Pose> next, std::optional<PoseReader>& reader,
                       std::size_t at_once, file::Output& output, std::optional<PoseView>& view) {
  in_batches(next, reader, at_once, [&](std::span<const Pose> poses) { ask(poses, output, view); });
}

void SeveralTools::ask(std::span<const Pose> poses, file::Output& output,
                       std::optional<PoseView>& view) {
  const std::size_t tools = queries_.size();
  std::vector<Job> questions;
  for (const Pose& pose : poses)
    for (std::uint32_t t = 0; t < tools; ++t) questions.push_back({pose, t});
  std::vector<Result> results(questions.size());
  const auto begin = std::chrono::steady_clock::now();
  if (poses.size() == 1) {  // the whole device answers each sooner
    for (std::size_t t = 0; t < tools; ++t) results[t] = together_[t]->run(cloud_, poses.front());
  } else {
    ToolQuery::run(together_, cloud_, questions, results);
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  seconds_.insert(seconds_.end(), results.size(),
                  took.count() / static_cast<double>(results.size()));
  for (std::size_t k = 0; k < results.size(); ++k) {
    const std::size_t tool = k % tools;
    output.append(result_line(asked_ + k / tools, results[k], together_[tool]->level(), measure_,
                              queries_[tool].reason(), {}, tool));
  }
  if (view) view->add_batch(together_, cloud_, poses);
  asked_ += poses.size();
}

std::vector<std::uint32_t> SeveralTools::levels() const {
  std::vector<std::uint32_t> levels;
  for (const ToolQuery* query : together_) levels.push_back(query->level().sphere_count);
  return levels;
}

}  // namespace vpm::tools
