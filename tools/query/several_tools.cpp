// Mode of vpm-query that asks every tool at every pose in a cloud.
#include <chrono>
#include <cstdint>
#include <span>

#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/contact_lines.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"

namespace vpm::tools {
namespace {

// Queries of all tools, each at the level that the request chooses for it.
class SeveralTools {
 public:
  // `asked` poses were asked by a run that was interrupted.
  SeveralTools(QuerySetup& setup, CloudScene& scene, const Pose& first_pose, std::size_t asked)
      : setup_(setup),
        scene_(scene),
        tools_(setup.tools.size()),
        query_(setup.tools, setup.options, setup.level, scene.scene(), first_pose),
        poses_asked_(asked) {
    for (std::size_t tool = 0; tool < tools_; ++tool) note_scale(setup.program, query_, tool);
  }

  // Writes a line for each pose and tool: pose by pose, in the order of the tools.
  void ask(const std::vector<AskedPose>& asked, ResultOutput& output) {
    contacts_.clear();
    const std::vector<Result> results = timed_results(asked);
    for (std::size_t k = 0; k < results.size(); ++k) {
      const std::size_t tool = k % tools_;
      scene_.see(asked[k / tools_].pose, tool, results[k]);
      nlohmann::ordered_json line =
          result_line(poses_asked_ + k / tools_, asked[k / tools_].id, results[k],
                      query_.level(tool), setup_.options.measure, query_.reason(tool), {}, tool);
      if (!contacts_.empty()) line["contacts"] = contacts_of_pose(contacts_[k]);
      setup_.collisions.answer(results[k], line);
      output.append(line);
    }
    if (setup_.view) setup_.view->add_batch(query_, scene_.scene(), jobs_of(asked));
    poses_asked_ += asked.size();
  }

  std::size_t asked() const { return poses_asked_; }
  // Returns the time of each answer, which is the mean of those asked together, s.
  const std::vector<double>& seconds() const { return seconds_; }

  const LevelQuery& query() const { return query_; }

 private:
  std::vector<Result> timed_results(const std::vector<AskedPose>& asked) {
    std::vector<Job> jobs;
    for (const AskedPose& one : asked)
      for (std::uint32_t t = 0; t < tools_; ++t) jobs.push_back({one.pose, t, one.solids});
    std::vector<Result> results(jobs.size());
    const auto start = std::chrono::steady_clock::now();
    const bool tells_contacts = setup_.arguments.contacts > 0;  // a batch leaves none
    if (asked.size() == 1 || tells_contacts) {  // the whole device answers each sooner
      for (std::size_t k = 0; k < jobs.size(); ++k) {
        const auto& [pose, tool, solids] = jobs[k];
        results[k] = query_.run(scene_.scene(), pose, tool, solids);
        if (tells_contacts) contacts_.push_back(query_.contacts(tool));
      }
    } else {
      query_.run(scene_.scene(), jobs, results);
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    seconds_.insert(seconds_.end(), results.size(),
                    taken.count() / static_cast<double>(results.size()));
    return results;
  }

  QuerySetup& setup_;
  CloudScene& scene_;
  std::size_t tools_;
  LevelQuery query_;
  std::size_t poses_asked_;
  std::vector<double> seconds_;
  std::vector<std::vector<Contact>> contacts_;  // of each answer, if they are told
};

}  // namespace

void run_several_tools(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  PoseSource source(a);
  CloudScene scene(setup);
  const Pose first = source.first().pose;
  ResultOutput output(setup.program, a, result_columns());
  SeveralTools tools(setup, scene, first, output.pass_over(setup.tools.size()));
  source.pass_over(tools.asked());
  for (auto poses = source.next(a.batch); !poses.empty(); poses = source.next(a.batch))
    tools.ask(poses, output);
  output.finish();
  note_deviation(setup.program, "", source.largest_deviation());
  scene.warn_at_end();
  nlohmann::json stats = query_stats(tools.seconds(), scene.prepare_seconds(), {});
  if (!a.clouds.empty()) stats["cloud_points"] = scene.points();
  add_levels(stats, tools.query(), setup.tools.size());
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
