// Modes of vpm-query that ask one tool at poses in a cloud, one by one or in batches.
#include <vpm/device.h>

#include <exception>
#include <memory>
#include <string>
#include <string_view>
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
    std::string line;
    AnsweredPose answered = answer(query_, asked_, asked, line);
    output_.append(line, 1);
    note(std::move(answered));
    if (setup_.view) setup_.view->add({asked.pose, 0, asked.solids}, last_result_, query_);
  }

  void ask_together(const std::vector<AskedPose>& asked) {
    std::vector<Result> results(asked.size());
    const std::vector<Job> jobs = jobs_of(asked);
    query_.run(scene_.scene(), jobs, results);
    for (std::size_t k = 0; k < asked.size(); ++k) {
      std::string line;
      AnsweredPose answered = answer_of(query_, asked_, asked[k], results[k], line);
      output_.append(line, 1);
      note(std::move(answered));
    }
    if (setup_.view) setup_.view->add_batch(query_, scene_.scene(), jobs);
  }

  // Reads all poses, answers them on several threads, and writes the answers in order. The threads
  // read plain lines too.
  void ask_by_threads(PoseSource& source, int threads) {
    while (!ask_until_unclear(source, threads)) {
    }
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
  // Where a thread meets a line of which it alone cannot tell what it asks.
  struct UnclearLine {};

  // Asks the poses of the source. Ends before a line that is unclear, and returns false.
  bool ask_until_unclear(PoseSource& source, int threads) {
    PoseSpread spread(
        static_cast<std::size_t>(threads),
        [&] {
          const auto query = std::make_shared<LevelQuery>(query_.another());
          return [this, query](const PoseChunk& chunk) { return answer_chunk(*query, chunk); };
        },
        [&](std::vector<AnsweredChunk> answered) { take(std::move(answered), source); });
    try {
      const std::exception_ptr unread = add_all(source, spread);
      spread.finish();  // what was read is answered first
      if (unread) std::rethrow_exception(unread);
    } catch (const UnclearLine&) {
      std::string left;
      for (const PoseChunk& chunk : spread.stop()) left += chunk.lines.text;
      source.give_back(std::string_view(left).substr(read_bytes_));
      return false;
    }
    return true;
  }
  // Adds all poses; returns why the last one cannot be read, if it is so.
  std::exception_ptr add_all(PoseSource& source, PoseSpread& spread) {
    std::size_t next = asked_;
    bool are_lines_out = false;
    const auto add = [&](const PoseChunk& chunk) {
      next += chunk.count();
      spread.add(chunk);
    };
    try {
      for (;;) {
        if (std::optional<PoseLines> lines = source.next_lines()) {
          add({next, {}, std::move(*lines)});
          are_lines_out = true;
          continue;
        }
        // What comes may belong to lines that are out, unless these are clear.
        if (std::exchange(are_lines_out, false)) spread.finish();
        std::vector<AskedPose> poses = source.next_together();
        if (poses.empty()) return nullptr;
        add({next, std::move(poses), {}});
      }
    } catch (const UnclearLine&) {
      throw;
    } catch (...) {
      return std::current_exception();
    }
  }

  // Asks the poses of a chunk. Threads may do so at once, each with its query.
  AnsweredChunk answer_chunk(LevelQuery& query, const PoseChunk& chunk) const {
    AnsweredChunk answered;
    PoseParser parser = chunk.lines.parser;
    const auto add = [&](const AskedPose& asked) {
      const std::size_t index = chunk.first + answered.poses.size();
      answered.poses.push_back(answer(query, index, asked, answered.text));
    };
    try {
      for (const AskedPose& asked : chunk.poses) add(asked);
      while (answered.read_bytes < chunk.lines.text.size()) {
        const std::size_t begin = answered.read_bytes, end = chunk.lines.text.find('\n', begin);
        const std::optional<AskedPose> asked =
            asked_on(chunk.lines.text.substr(begin, end - begin), setup_.solids.size(), parser);
        if (!asked) throw UnclearLine();
        add(*asked);
        answered.read_bytes = end + 1;
      }
    } catch (...) {
      answered.failure = std::current_exception();
    }
    answered.largest_deviation = parser.largest_deviation();
    return answered;
  }
  void take(std::vector<AnsweredChunk> answered, PoseSource& source) {
    std::string text;
    std::size_t lines = 0;
    for (const AnsweredChunk& chunk : answered) {
      text += chunk.text;
      lines += chunk.poses.size();
    }
    if (lines > 0) output_.append(text, lines);
    for (AnsweredChunk& chunk : answered) {
      for (AnsweredPose& pose : chunk.poses) note(std::move(pose));
      source.add_deviation(chunk.largest_deviation);
      read_bytes_ = chunk.read_bytes;
    }
  }

  // Asks the `index`-th pose, and adds its line. Threads may do so at once, each with its query.
  AnsweredPose answer(LevelQuery& query, std::size_t index, const AskedPose& asked,
                      std::string& text) const {
    if (setup_.arguments.collides_only) return hit_of(query, index, asked, text);
    return answer_of(query, index, asked, query.run(scene_.scene(), asked.pose, 0, asked.solids),
                     text);
  }
  AnsweredPose hit_of(LevelQuery& query, std::size_t index, const AskedPose& asked,
                      std::string& text) const {
    const Collides found = query.collides(scene_.scene(), asked.pose,
                                          setup_.collisions.unseen_limit(), 0, asked.solids);
    text += output_.text_of(collision_line(index, asked.id, text_of(found), query.level(),
                                           setup_.options.measure, query.reason()));
    return {asked, {}, found, "", query.seconds()};
  }
  AnsweredPose answer_of(const LevelQuery& query, std::size_t index, const AskedPose& asked,
                         const Result& result, std::string& text) const {
    nlohmann::ordered_json line = result_line(index, asked.id, result, query.level(),
                                              setup_.options.measure, query.reason(), {});
    if (setup_.arguments.bodies) line["bodies"] = bodies_of(query.parts());
    if (setup_.arguments.contacts > 0) line["contacts"] = contacts_of_pose(query.contacts());
    std::string above = setup_.collisions.show(result, line);
    text += output_.text_of(line);
    return {asked, result, {}, std::move(above), query.seconds()};
  }
  // Takes into account what was written.
  void note(AnsweredPose answered) {
    if (answered.collides) {
      setup_.collisions.count(*answered.collides);
    } else {
      scene_.see(answered.asked.pose, 0, answered.result);
      setup_.collisions.count(answered.result, answered.above);
    }
    seconds_.push_back(answered.seconds);
    last_result_ = answered.result;
    last_ = std::move(answered.asked);
    ++asked_;
  }

  QuerySetup& setup_;
  CloudScene& scene_;
  ResultOutput& output_;
  std::size_t asked_;
  std::size_t read_bytes_ = 0;  // of the lines of the chunk that was taken last
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
