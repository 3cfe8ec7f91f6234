// Modes of vpm-query that ask one tool at poses in a cloud, one by one or in batches.
#include <vpm/device.h>

#include <exception>
#include <utility>

#include "tools/common/recorded_frames.h"
#include "tools/query/cloud_scene.h"
#include "tools/query/contact_lines.h"
#include "tools/query/mode.h"
#include "tools/query/pose_spread.h"
#include "tools/query/query_report.h"
#include "tools/query/result_output.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

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
    write(answer(query_, asked_, asked));
    if (setup_.view) setup_.view->add({asked.pose, 0, asked.solids}, last_result_, query_);
  }

  void ask_together(const std::vector<AskedPose>& asked) {
    std::vector<Result> results(asked.size());
    const std::vector<Job> jobs = jobs_of(asked);
    query_.run(scene_.scene(), jobs, results);
    for (std::size_t k = 0; k < asked.size(); ++k)
      write(answer_of(query_, asked_, asked[k], results[k]));
    if (setup_.view) setup_.view->add_batch(query_, scene_.scene(), jobs);
  }

  // Reads all poses, answers each on one of several threads, and writes the answers in order.
  void ask_by_threads(PoseSource& source, int threads) {
    std::vector<LevelQuery> queries;
    for (int k = 0; k < threads; ++k) queries.push_back(query_.another());
    const std::size_t first = asked_;
    PoseSpread spread(
        queries.size(),
        [&](std::size_t thread, std::size_t index, const AskedPose& asked) {
          return answer(queries[thread], first + index, asked);
        },
        [&](const AnsweredPose& answered) { write(answered); });
    std::exception_ptr unread;
    try {
      for (auto poses = source.next(1); !poses.empty(); poses = source.next(1))
        spread.add(std::move(poses.front()));
    } catch (...) {
      unread = std::current_exception();
    }
    spread.finish();  // what was read is answered first
    if (unread) std::rethrow_exception(unread);
  }

  // Queries the last pose again, where its states of spheres are not those of the query.
  void ask_last_again() { query_.run(scene_.scene(), last_.pose, 0, last_.solids); }

  // Returns the number of poses that were asked, those of an interrupted run too.
  std::size_t asked() const { return asked_; }
  const LevelQuery& query() const { return query_; }
  // Returns the time of each answer, s.
  const std::vector<double>& seconds() const { return seconds_; }
  const Pose& last() const { return last_.pose; }

 private:
  // Asks the `index`-th pose. Threads may do so at once, each with its query.
  AnsweredPose answer(LevelQuery& query, std::size_t index, const AskedPose& asked) const {
    if (setup_.arguments.collides_only) return hit_of(query, index, asked);
    return answer_of(query, index, asked, query.run(scene_.scene(), asked.pose, 0, asked.solids));
  }
  AnsweredPose hit_of(LevelQuery& query, std::size_t index, const AskedPose& asked) const {
    const Collides found = query.collides(scene_.scene(), asked.pose,
                                          setup_.collisions.unseen_limit(), 0, asked.solids);
    return {asked,
            {},
            found,
            collision_line(index, asked.id, text_of(found), query.level(), setup_.options.measure,
                           query.reason()),
            query.seconds()};
  }
  AnsweredPose answer_of(const LevelQuery& query, std::size_t index, const AskedPose& asked,
                         const Result& result) const {
    AnsweredPose answered{asked,
                          result,
                          {},
                          result_line(index, asked.id, result, query.level(),
                                      setup_.options.measure, query.reason(), {}),
                          query.seconds()};
    if (setup_.arguments.bodies) answered.line["bodies"] = bodies_of(query.parts());
    if (setup_.arguments.contacts > 0)
      answered.line["contacts"] = contacts_of_pose(query.contacts());
    return answered;
  }
  void write(AnsweredPose answered) {
    if (answered.collides) {
      setup_.collisions.count(*answered.collides);
    } else {
      scene_.see(answered.asked.pose, 0, answered.result);
      setup_.collisions.answer(answered.result, answered.line);
    }
    output_.append(answered.line);
    seconds_.push_back(answered.seconds);
    last_result_ = answered.result;
    last_ = std::move(answered.asked);
    ++asked_;
  }

  QuerySetup& setup_;
  CloudScene& scene_;
  ResultOutput& output_;
  std::size_t asked_;
  LevelQuery query_;
  std::vector<double> seconds_;
  AskedPose last_;
  Result last_result_;
};

// Returns the number of threads that poses are spread over: 1 where each depends on the one before
// it, where a device answers, and for a page, which shows the spheres of each.
int threads_of(const QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  const bool is_alone = a.poses.empty() || a.coherent || a.deadline_us || setup.view;
  return is_alone || setup.options.device.is_cuda() ? 1 : thread_count();
}

// Asks all poses; returns true if the query holds the states of the last one's spheres.
bool ask_all(const QuerySetup& setup, PoseSource& source, PoseQueries& queries) {
  const Arguments& a = setup.arguments;
  if (const int threads = threads_of(setup); threads > 1) {
    queries.ask_by_threads(source, threads);
    return false;
  }
  // A batch leaves no parts of bodies, and no contacts.
  const bool together = a.batch > 1 && !a.bodies && a.contacts == 0;
  const std::size_t most = together ? a.batch : 1;
  for (auto poses = source.next(most); !poses.empty(); poses = source.next(most))
    together ? queries.ask_together(poses) : queries.ask(poses.front());
  return !together;
}

}  // namespace

void run_poses(QuerySetup& setup) {
  const Arguments& a = setup.arguments;
  PoseSource source(a);
  CloudScene scene(setup);
  ResultOutput output(setup.program, a, result_columns());
  PoseQueries queries(setup, scene, source.first().pose, output);
  note_scale(setup.program, queries.query());
  source.pass_over(queries.asked());
  const bool has_states = ask_all(setup, source, queries);
  output.finish();
  note_deviation(setup.program, "", source.largest_deviation());
  scene.warn_at_end();
  if (!has_states && !a.spheres_out.empty()) queries.ask_last_again();
  nlohmann::json stats = query_stats(queries.seconds(), scene.prepare_seconds(), a.deadline_us);
  if (!a.clouds.empty()) stats["cloud_points"] = scene.points();
  add_levels(stats, queries.query());
  write_last_spheres(setup, queries.query(), queries.last());
  write_stats_and_view(setup, std::move(stats));
}

}  // namespace vpm::tools
