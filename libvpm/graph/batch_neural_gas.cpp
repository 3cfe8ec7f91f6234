#include "libvpm/graph/batch_neural_gas.h"

#include <algorithm>
#include <array>

namespace vpm {
namespace {

// Neighbourhood: a prototype of rank k learns with factor q^k. q starts at exp(-1/2) and is squared
// every second step, which halves the neighbourhood's range; the last steps are k-means.
constexpr double kFirstFactor = 0.60653065971263342;
constexpr int kSteps = 18;

// Starting places in the box, in units of half its extent. They differ along every axis, so that
// spheres in a row or in a plane separate too.
constexpr std::array<Vec3, kPrototypes> kPlaces{
    Vec3{-0.75, -0.25, 0.25}, {0.25, -0.75, -0.25}, {-0.25, 0.75, -0.75}, {0.75, 0.25, 0.75}};

using Prototypes = std::array<Vec3, kPrototypes>;
using Ranking = std::array<std::uint8_t, kPrototypes>;  // prototypes, nearest first

// Returns the weight of a sphere, r^4 as in the paper: large spheres attract prototypes.
double magnification(const Sphere& s) {
  const double squared = s.radius * s.radius;
  return squared * squared;
}

Ranking rank(Vec3 x, const Prototypes& prototypes) {
  std::array<double, kPrototypes> distance;
  Ranking ranking;
  for (std::uint8_t p = 0; p < kPrototypes; ++p) {
    const double d = squared_norm(x - prototypes[p]);
    std::uint8_t k = p;
    for (; k > 0 && distance[k - 1u] > d; --k) {
      distance[k] = distance[k - 1u];
      ranking[k] = ranking[k - 1u];
    }
    distance[k] = d;
    ranking[k] = p;
  }
  return ranking;
}

Prototypes first_prototypes(std::span<const Sphere> spheres) {
  Vec3 low = spheres.front().center, high = low;
  for (const Sphere& s : spheres) {
    low = {std::min(low.x, s.center.x), std::min(low.y, s.center.y), std::min(low.z, s.center.z)};
    high = {std::max(high.x, s.center.x), std::max(high.y, s.center.y),
            std::max(high.z, s.center.z)};
  }
  const Vec3 middle = 0.5 * (low + high), half = 0.5 * (high - low);
  Prototypes prototypes;
  for (std::size_t p = 0; p < kPrototypes; ++p) {
    prototypes[p] =
        middle + Vec3{kPlaces[p].x * half.x, kPlaces[p].y * half.y, kPlaces[p].z * half.z};
  }
  return prototypes;
}

void learn(std::span<const Sphere> spheres, double factor, Prototypes& prototypes) {
  std::array<Vec3, kPrototypes> moment{};
  std::array<double, kPrototypes> mass{};
  for (const Sphere& s : spheres) {
    double weight = magnification(s);
    for (const std::uint8_t p : rank(s.center, prototypes)) {
      moment[p] += weight * s.center;
      mass[p] += weight;
      weight *= factor;
    }
  }
  for (std::size_t p = 0; p < kPrototypes; ++p) {
    if (mass[p] > 0) prototypes[p] = moment[p] / mass[p];
  }
}

}  // namespace

std::vector<std::uint8_t> batch_neural_gas(std::span<const Sphere> spheres) {
  Prototypes prototypes = first_prototypes(spheres);
  double factor = kFirstFactor;
  for (int step = 0; step < kSteps; ++step) {
    learn(spheres, factor, prototypes);
    if (step % 2 == 1) factor *= factor;
  }
  std::vector<std::uint8_t> cluster;
  cluster.reserve(spheres.size());
  for (const Sphere& s : spheres) cluster.push_back(rank(s.center, prototypes)[0]);
  return cluster;
}

}  // namespace vpm
