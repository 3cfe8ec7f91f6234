#include "libvpm/packing/ascent.h"

#include <algorithm>
#include <vector>

#include "libvpm/packing/linear_programme.h"

namespace vpm {
namespace {

constexpr int kMaxSteps = 60;           // convergence is quadratic and needs about ten
constexpr double kConverged = 1e-12;    // smallest relative gain worth a step
constexpr double kBox = 0.3;            // trust region: |delta| < 0.52 d stays inside the ball
constexpr double kSmallestBox = 1e-10;  // relative to d
constexpr std::size_t kMaxObstacles = 20;

// Obstacles met on the way, with linearisations about the current point.
struct Contacts {
  std::vector<Obstacle> obstacles;
  std::vector<LinearBound> bounds;

  void add(const Space& space, Obstacle obstacle, Vec3 x) {
    obstacles.push_back(obstacle);
    bounds.push_back(linearised(space, obstacle, x));
  }
  bool has(Obstacle obstacle) const {
    return std::find(obstacles.begin(), obstacles.end(), obstacle) != obstacles.end();
  }
  double separation(const Space& space, Vec3 x) const {
    double d = HUGE_VAL;
    for (const Obstacle o : obstacles) d = std::min(d, linearised(space, o, x).value);
    return d;
  }
  // Linearises about a new point, and drops obstacles that no step within `horizon` can meet.
  void move_to(const Space& space, Vec3 x, double horizon) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < obstacles.size(); ++i) {
      const LinearBound bound = linearised(space, obstacles[i], x);
      if (bound.value > horizon) continue;
      obstacles[kept] = obstacles[i];
      bounds[kept++] = bound;
    }
    obstacles.resize(kept);
    bounds.resize(kept);
    while (obstacles.size() > kMaxObstacles) {
      const auto slackest =
          std::max_element(bounds.begin(), bounds.end(),
                           [](const auto& a, const auto& b) { return a.value < b.value; });
      obstacles.erase(obstacles.begin() + (slackest - bounds.begin()));
      bounds.erase(slackest);
    }
  }

 private:
  static LinearBound linearised(const Space& space, Obstacle obstacle, Vec3 x) {
    if (obstacle.kind == Obstacle::Kind::sphere) {
      const Sphere& s = space.spheres()[obstacle.index];
      const double distance = norm(x - s.center);
      return {normalized_or_zero(x - s.center), distance - s.radius};
    }
    const Vec3 from = x - space.closest_on_triangle(obstacle.index, x);
    return {normalized_or_zero(from), norm(from)};
  }
};

}  // namespace

Sphere ascend(const Space& space, Vec3 start, const SeparationBound& from, double longest_step) {
  Sphere best{start, from.value};
  if (from.nearest.kind == Obstacle::Kind::none) return best;
  Contacts contacts;
  contacts.obstacles.reserve(kMaxObstacles + 1);
  contacts.bounds.reserve(kMaxObstacles + 1);
  contacts.add(space, from.nearest, start);
  const double largest_box = std::min(kBox, longest_step / best.radius);
  double box = largest_box * best.radius;
  for (int i = 0; i < kMaxSteps && box > kSmallestBox * best.radius; ++i) {
    const MaxMinStep step = max_min_step(contacts.bounds, box);
    if (!(step.value - best.radius > kConverged * best.radius)) break;
    const Vec3 x = best.center + step.delta;
    const SeparationBound there = space.separation(x, contacts.separation(space, x));
    const bool unforeseen =
        there.nearest.kind != Obstacle::Kind::none && !contacts.has(there.nearest);
    if (there.value > best.radius) {
      best = {x, there.value};
      box = largest_box * best.radius;
      contacts.move_to(space, x, best.radius * (1 + 4 * kBox));
      if (unforeseen) contacts.add(space, there.nearest, x);
      if (contacts.bounds.empty()) break;  // nothing within the search radius
    } else if (unforeseen) {
      contacts.add(space, there.nearest, best.center);
    } else {
      box *= 0.5;
    }
  }
  return best;
}

}  // namespace vpm
