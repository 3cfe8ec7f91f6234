#include "libvpm/query/level_choice.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "libvpm/core/error.h"

namespace vpm {
namespace {

std::string percent(double fraction) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g %%", 100 * fraction);
  return text;
}

// Returns the least number of per cent with three digits that is not below the fraction, so that
// who asks for it gets it.
std::string percent_from(double fraction) {
  const double digits = std::pow(10, 2 - std::floor(std::log10(100 * fraction)));
  double steps = std::round(100 * fraction * digits);
  if (steps / digits / 100 < fraction) ++steps;
  return percent(steps / digits / 100);
}

}  // namespace

std::size_t coarsest_level_within(const ToolModel& tool, double max_error) {
  if (!(max_error > 0 && max_error < 1)) {
    throw Error(ErrorKind::invalid_argument, "the error must lie between 0 and 1 (0 % and 100 %)");
  }
  if (tool.calibration.size() != tool.levels.size()) {
    refuse("the tool model has no calibration", {}, "make it again with `calibrate`");
  }
  if (tool.levels.size() < 2) {
    refuse("the tool model has one level only", {}, "make it again with `levels`");
  }
  double best = 1;
  for (std::size_t k = 0; k < tool.levels.size(); ++k) {
    if (tool.calibration[k].worst <= max_error) return k;
    best = std::min(best, tool.calibration[k].worst);
  }
  refuse("no level of the tool model keeps an error of " + percent(max_error), {},
         "the best has " + percent_from(best) + ": allow as much, or pack more spheres");
}

DeadlineLevel::DeadlineLevel(std::vector<double> probed, double deadline, std::size_t finest)
    : probed_(std::move(probed)), deadline_(deadline), finest_(finest) {
  choose();
}

// Returns the ratio of times taken to times probed, at least 1: a tool in free space is fast and
// says nothing about the next contact.
double DeadlineLevel::slowness() const {
  std::array<double, kRecent> sorted = recent_;
  std::nth_element(sorted.begin(), sorted.end() - 2, sorted.end());
  return std::max(1.0, sorted[kRecent - 2]);
}

void DeadlineLevel::choose() {
  const double room = kMargin * deadline_ / slowness();
  level_ = finest_;
  while (level_ > 0 && probed_[level_] > room) --level_;
}

bool DeadlineLevel::keeps() const {
  return probed_[level_] * slowness() <= deadline_;
}

void DeadlineLevel::took(double time) {
  recent_[next_] = time / probed_[level_];
  next_ = (next_ + 1) % kRecent;
  choose();
}

}  // namespace vpm
