#include "libvpm/recording/timed_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/recording/median_interval.h"

namespace vpm {

namespace {

bool are_equal(const Pose& a, const Pose& b) {
  return a.translation == b.translation && a.rotation.row0 == b.rotation.row0 &&
         a.rotation.row1 == b.rotation.row1 && a.rotation.row2 == b.rotation.row2;
}

Pose between(const Pose& from, const Pose& to, double part) {
  return {interpolate(from.rotation, to.rotation, part),
          from.translation + part * (to.translation - from.translation)};
}

[[noreturn]] void refuse_order(double before, double time, const std::string& place) {
  char text[96];
  if (time == before) {
    std::snprintf(text, sizeof text, "times must ascend, but %.6f s has two poses", time);
    refuse(text, place, "remove one of the two lines");
  }
  std::snprintf(text, sizeof text, "times must ascend, but %.6f s comes after %.6f s", time,
                before);
  refuse(text, place, "sort the lines by their times");
}

}  // namespace

TimedPath::TimedPath(PoseReader& reader, UndefinedPoses undefined) {
  while (const std::optional<Pose> pose = next(reader, undefined)) add(reader, *pose);
  if (undefined_ > 0 && poses_.size() == places_.size())
    refuse("none of its " + std::to_string(undefined_) + " poses has finite numbers",
           reader.place());
  if (poses_.empty()) reader.refuse_empty();
}

std::optional<Pose> TimedPath::next(PoseReader& reader, UndefinedPoses undefined) {
  while (true) {
    try {
      std::optional<Pose> pose = reader.next();
      if (!pose || !reader.time() || std::isfinite(*reader.time())) return pose;
      if (undefined == UndefinedPoses::refused) refuse("the time is not finite", reader.place());
    } catch (const Error&) {
      if (undefined == UndefinedPoses::refused || !reader.is_undefined()) throw;
    }
    ++undefined_;
    if (reader.time()) continue;
    places_.push_back(poses_.size());
    return Pose{};
  }
}

// True if the last pose, with its time and solids, is this one.
bool TimedPath::is_last(double time, const Pose& pose, const std::vector<Pose>& solids) const {
  return !times_.empty() && time == times_.back() && times_.size() == poses_.size() &&
         are_equal(pose, poses_.back()) &&
         std::ranges::equal(solids, solids_of(poses_.size() - 1), are_equal);
}

void TimedPath::add(const PoseReader& reader, const Pose& pose) {
  if (const std::optional<double> time = reader.time()) {
    if (is_last(*time, pose, reader.solids())) {
      ++doubled_;
      return;
    }
    if (!times_.empty() && !(*time > times_.back()))
      refuse_order(times_.back(), *time, reader.place());
    times_.push_back(*time);
  }
  add_solids(reader);
  poses_.push_back(pose);
  if (!times_.empty() && times_.size() != poses_.size())
    refuse("either every pose has a time or none", reader.place());
}

// Adds the poses of solids beside the next pose.
void TimedPath::add_solids(const PoseReader& reader) {
  if (!poses_.empty() && reader.solids().size() != solids())
    refuse("\"solids\" has " + std::to_string(reader.solids().size()) +
               " poses, and those before have " + std::to_string(solids()),
           reader.place(), "give every pose of a path as many, or none");
  if (!reader.solids().empty()) solids_.push_back(reader.solids());
}

bool TimedPath::is_undefined(std::size_t k) const {
  return std::binary_search(places_.begin(), places_.end(), k);
}

TimedPath::Place TimedPath::place_of(double time) const {
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return {0, 0};
  if (after == times_.end()) return {times_.size() - 1, 0};
  const std::size_t next = static_cast<std::size_t>(after - times_.begin());
  return {next - 1, (time - times_[next - 1]) / (times_[next] - times_[next - 1])};
}

Pose TimedPath::at(double time) const {
  const auto [from, part] = place_of(time);
  return part == 0 ? poses_[from] : between(poses_[from], poses_[from + 1], part);
}

std::vector<Pose> TimedPath::solids_at(double time) const {
  const auto [from, part] = place_of(time);
  std::vector<Pose> poses = solids_of(from);
  for (std::size_t k = 0; part > 0 && k < poses.size(); ++k)
    poses[k] = between(poses[k], solids_[from + 1][k], part);
  return poses;
}

double TimedPath::speed_of_solid(std::size_t k, double time, double within, double reach) const {
  double fastest = 0;
  for (std::size_t i = place_of(time - within).from + 1;
       i < times_.size() && times_[i - 1] <= time + within; ++i) {
    const Pose &from = solids_[i - 1][k], &to = solids_[i][k];
    const double turned = norm(rotation_vector(to.rotation * transpose(from.rotation)));
    const double length = norm(to.translation - from.translation) + reach * turned;
    fastest = std::max(fastest, length / (times_[i] - times_[i - 1]));
  }
  return fastest;
}

std::optional<PoseGap> TimedPath::improbable_gap() const {
  constexpr double kShortest = 0.5, kMedians = 10;
  PoseGap longest;
  for (std::size_t k = 1; k < times_.size(); ++k)
    if (times_[k] - times_[k - 1] > longest.end - longest.start)
      longest = {times_[k - 1], times_[k]};
  const double length = longest.end - longest.start;
  if (length > kShortest && length > kMedians * median_interval(times_)) return longest;
  return std::nullopt;
}

SampledPath::SampledPath(TimedPath path, double rate) : path_(std::move(path)), rate_(rate) {
  constexpr double kMaxSteps = 1e9;
  const double steps = path_.has_times()
                           ? std::floor((path_.end() - path_.start()) * rate * (1 + 1e-12)) + 1
                           : static_cast<double>(path_.poses().size());
  if (!(steps <= kMaxSteps))
    refuse("the path is longer than 10^9 steps at this rate", {}, "are its times seconds?");
  steps_ = static_cast<std::size_t>(steps);
}

Pose SampledPath::pose(std::size_t step) const {
  return path_.has_times() ? path_.at(path_.start() + time(step)) : path_.poses()[step];
}

std::vector<Pose> SampledPath::solids(std::size_t step) const {
  return path_.has_times() ? path_.solids_at(path_.start() + time(step)) : path_.solids_of(step);
}

}  // namespace vpm
