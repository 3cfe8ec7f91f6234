#include "tools/bench/peers/contest.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "libvpm/core/vec3.h"
#include "libvpm/recording/loop_clock.h"
#include "tools/bench/errors.h"
#include "tools/bench/statistics.h"

namespace vpm::bench {
namespace {

// The two ways in which penalty forces are added up.
enum class Rule { sum, mean_above_ten };

Wrench wrench_by(Rule rule, const PeerAnswer& answer) {
  if (rule == Rule::sum || answer.contacts <= kContactsSummed) return answer.wrench;
  const double part = static_cast<double>(kContactsSummed) / static_cast<double>(answer.contacts);
  return {part * answer.wrench.force, part * answer.wrench.torque};
}

// Returns the factor by which the forces fit the true ones best.
double best_factor(Rule rule, const std::vector<PeerAnswer>& answers,
                   const std::vector<PeerTruth>& truth) {
  double product = 0, square = 0;
  for (std::size_t k = 0; k < answers.size(); ++k) {
    if (!truth[k].has_wrench) continue;
    const Vec3 force = wrench_by(rule, answers[k]).force;
    product += dot(force, truth[k].wrench.force), square += squared_norm(force);
  }
  return square > 0 ? product / square : 1;
}

nlohmann::json mean_and_worst(const MeanAndWorst& of) {
  return of.count() == 0 ? nlohmann::json()
                         : nlohmann::json{{"mean", of.mean()}, {"worst", of.worst()}};
}

// Times, answers and forces over noise of one contender.
struct Record {
  std::vector<double> seconds;
  std::vector<PeerAnswer> answers;               // at the poses
  std::vector<std::vector<PeerAnswer>> at_rest;  // of each still pose, over the frames
};

// Root of the mean square by which forces at one pose stray from their mean over the frames,
// relative to `volume`; its mean over the poses.
nlohmann::json jitter_of(Rule rule, double factor, const Record& record, double volume) {
  MeanAndWorst spread;
  for (const std::vector<PeerAnswer>& frames : record.at_rest) {
    Vec3 mean;
    double square = 0;
    const auto count = static_cast<double>(frames.size());
    for (const PeerAnswer& frame : frames) mean += wrench_by(rule, frame).force / count;
    for (const PeerAnswer& frame : frames)
      square += squared_norm(wrench_by(rule, frame).force - mean) / (count - 1);
    if (!std::isnan(square)) spread.add(std::abs(factor) * std::sqrt(square) / volume);
  }
  return mean_and_worst(spread);
}

nlohmann::json forces_of(Rule rule, const Contest& contest, const Contender& contender,
                         const Record& record) {
  const std::vector<PeerTruth>& truth = *contender.truth;
  const bool is_scaled = contender.is_scaled || rule == Rule::mean_above_ten;
  const double factor = is_scaled ? best_factor(rule, record.answers, truth) : 1;
  MeanAndWorst force, torque;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const Wrench w = wrench_by(rule, record.answers[k]);
    if (!truth[k].has_wrench || std::isnan(w.force.x)) continue;
    force.add(norm(factor * w.force - truth[k].wrench.force) / contest.volume);
    torque.add(norm(factor * w.torque - truth[k].wrench.torque) /
               (contest.volume * contest.radius));
  }
  return {{"force", mean_and_worst(force)},
          {"torque", mean_and_worst(torque)},
          {"jitter", jitter_of(rule, factor, record, contest.volume)}};
}

// Rounds of all contenders take turns; each goes through all poses in a row, as a loop does.
void ask_poses(const Contest& contest, int rounds, std::span<const Contender> contenders,
               std::vector<Record>& records) {
  for (int round = 0; round < rounds; ++round)
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      Peer& peer = *contenders[c].asked;
      peer.query(contest.poses.back());  // reads its memory into the caches
      records[c].answers.clear();
      for (const Pose& pose : contest.poses) {
        const double start = thread_seconds();
        records[c].answers.push_back(peer.query(pose));
        records[c].seconds.push_back(thread_seconds() - start);
      }
    }
}

void ask_frames(const Contest& contest, std::vector<Record>& records) {
  for (std::size_t frame = 1; frame <= contest.noisy_frames; ++frame) {
    const std::vector<Contender> contenders = contest.contenders(frame);
    for (std::size_t c = 0; c < contenders.size(); ++c) {
      records[c].at_rest.resize(contest.still.size());
      for (std::size_t k = 0; k < contest.still.size(); ++k)
        records[c].at_rest[k].push_back(contenders[c].asked->query(contest.still[k]));
    }
  }
}

nlohmann::json row_of(const Contest& contest, const Contender& contender, const Record& record) {
  MeanAndWorst volume;
  const std::vector<PeerTruth>& truth = *contender.truth;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double measured = record.answers[k].volume / contest.volume;
    if (!std::isnan(measured))
      volume.add(volume_error(measured, truth[k].volume / contest.volume, truth[k].unseen));
  }
  const Durations times(record.seconds);
  const std::size_t bytes = contender.asked->bytes(),
                    without = contender.asked->bytes_without_field();
  const bool has_whole = contest.whole_field > 0 && bytes > without;
  nlohmann::json row = forces_of(Rule::sum, contest, contender, record);
  row.update({{"kind", contest.kind},
              {"scene", contest.name},
              {"peer", contender.peer},
              {"setting", contender.setting},
              {"scaled", contender.is_scaled},
              {"volume", mean_and_worst(volume)},
              {"bytes", bytes},
              {"bytes_of_view", has_whole ? without + contest.whole_field : bytes},
              {"median_us", 1e6 * times.quantile(.5)},
              {"p99_us", 1e6 * times.quantile(.99)},
              {"poses", contest.poses.size()},
              {"within_us", nlohmann::json::array()}});
  if (contender.peer.starts_with("pointshell"))
    row["mean_above_ten"] = forces_of(Rule::mean_above_ten, contest, contender, record);
  return row;
}

// Marks the finest setting of each peer within each budget.
void mark_budgets(std::span<nlohmann::json> rows) {
  for (const double budget : kBudgets)
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const auto fits = [&](const nlohmann::json& row) {
        return row["peer"] == rows[k]["peer"] && row["median_us"].get<double>() <= budget;
      };
      if (fits(rows[k]) &&
          std::none_of(rows.begin() + static_cast<std::ptrdiff_t>(k) + 1, rows.end(), fits))
        rows[k]["within_us"].push_back(budget);
    }
}

}  // namespace

void run_contest(const Contest& contest, const SuiteOptions& options, nlohmann::json& rows) {
  std::vector<nlohmann::json> made;
  {
    const std::vector<Contender> contenders = contest.contenders(0);
    std::vector<Record> records(contenders.size());
    ask_poses(contest, options.quick ? 2 : 9, contenders, records);
    ask_frames(contest, records);
    for (std::size_t c = 0; c < contenders.size(); ++c)
      made.push_back(row_of(contest, contenders[c], records[c]));
  }
  mark_budgets(made);
  for (nlohmann::json& row : made) rows.push_back(std::move(row));
}

}  // namespace vpm::bench
