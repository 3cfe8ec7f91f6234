// Modes of vpm-query that ask one tool at poses in a cloud, one by one or in batches.
#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/mode.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

// Returns the job of each pose for a single tool.
std::vector<Job> jobs_of(const std::vector<AskedPose>& asked) {
  std::vector<Job> jobs;
  for (const AskedPose& one : asked) jobs.push_back({one.pose, 0, one.solids});
  return jobs;
}

// Queries of one tool and the lines of their results.
class PoseQueries {
 public:
  PoseQueries(QuerySetup& setup, CloudScene& scene, const Pose& first_pose, ResultOutput& output)
      : setup_(setup),
        scene_(scene),
        output_(output),
        asked_(setup.options.coherent ? 0 : output.pass_over(1)),
        query_(setup.tools.front(), setup.options, setup.level, scene.scene(), first_pose) {}

  void ask(const AskedPose& asked) {
    const Result result = query_.run(scene_.scene(), asked.pose, 0, asked.solids);
    write(asked, result);
    if (setup_.view) setup_.view->add(0, asked.pose, result, query_);
    last_ = asked;
  }

  void ask_together(const std::vector<AskedPose>& asked) {
    std::vector<Result> results(asked.size());
    query_.run(scene_.scene(), jobs_of(asked), results);
    for (std::size_t k = 0; k < asked.size(); ++k) write(asked[k], results[k]);
    if (setup_.view) setup_.view->add_batch(query_, scene_.scene(), poses_of(asked));
    last_ = asked.back();
  }

  // Queries the last pose again, since a batch leaves no states of spheres.
  void ask_last_again() { query_.run(scene_.scene(), last_.pose, 0, last_.solids); }

  // Returns the number of poses that were asked, those of an interrupted run too.
  std::size_t asked() const { return asked_; }
  const LevelQuery& query() const { return query_; }
  // Returns the time of each answer, s.
  const std::vector<double>& seconds() const { return seconds_; }
  const Pose& last() const { return last_.pose; }

 private:
  void write(const AskedPose& asked, const Result& result) {
    scene_.see(asked.pose, 0, result);
    nlohmann::ordered_json line = result_line(asked_++, asked.id, result, query_.level(),
                                              setup_.options.measure, query_.reason(), {});
    if (setup_.arguments.bodies) line["bodies"] = bodies_of(query_.parts());
    setup_.collisions.answer(result, line);
    output_.append(line);
    seconds_.push_back(query_.seconds());
  }

  QuerySetup& setup_;
  CloudScene& scene_;
  ResultOutput& output_;
  std::size_t asked_;
  LevelQuery query_;
  std::vector<double> seconds_;
  AskedPose last_;
};

}  // namespace

void run_poses(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  PoseSource source(a);
  CloudScene scene(setup);
  ResultOutput output(setup.program, a, result_columns());
  PoseQueries queries(setup, scene, source.first().pose, output);
  note_scale(setup.program, queries.query());
  source.pass_over(queries.asked());
  const bool together = a.batch > 1 && !a.bodies;  // a batch leaves no parts of bodies
  const std::size_t most = together ? a.batch : 1;
  for (auto poses = source.next(most); !poses.empty(); poses = source.next(most))
    together ? queries.ask_together(poses) : queries.ask(poses.front());
  output.finish();
  note_deviation(setup.program, "", source.largest_deviation());
  scene.warn_at_end();
  if (together && !a.spheres_out.empty()) queries.ask_last_again();
  nlohmann::json stats = query_stats(queries.seconds(), scene.prepare_seconds(), a.deadline_us);
  if (!a.cloud.empty()) stats["cloud_points"] = scene.points();
  add_levels(stats, queries.query());
  write_last_spheres(setup, queries.query(), queries.last());
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
