#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/core/parallel.h"
#include "libvpm/packing/outer_cover.h"

namespace vpm {
namespace {

constexpr int kLines = 512;  // along y and z

// Stretches of a line along x, each from its lower to its higher end.
using Stretches = std::vector<std::array<double, 2>>;

// Joins stretches that overlap, in ascending order.
void join(Stretches& stretches) {
  std::ranges::sort(stretches);
  Stretches joined;
  for (const auto& [from, to] : stretches) {
    if (joined.empty() || from > joined.back()[1])
      joined.push_back({from, to});
    else
      joined.back()[1] = std::max(joined.back()[1], to);
  }
  stretches.swap(joined);
}

double length(const Stretches& stretches) {
  double sum = 0;
  for (const auto& [from, to] : stretches) sum += to - from;
  return sum;
}

// Returns the length that both have; each is in ascending order and joined.
double shared(const Stretches& a, const Stretches& b) {
  double sum = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    sum += std::max(0.0, std::min((*i)[1], (*j)[1]) - std::max((*i)[0], (*j)[0]));
    (*i)[1] < (*j)[1] ? ++i : ++j;
  }
  return sum;
}

// Lines through the box about a solid and spheres, on which lengths are measured.
class Lines {
 public:
  Lines(const Solid& solid, const std::vector<Sphere>& spheres) : solid_(solid), spheres_(spheres) {
    for (const Vec3& p : solid.vertices) box_.add(p);
    for (const Sphere& s : spheres) {
      const Vec3 reach{s.radius, s.radius, s.radius};
      box_.add_box({s.center - reach, s.center + reach});
    }
    width_ = box_.size() / kLines;
  }

  // Returns the volumes of the solid, of the spheres' union, and of what both have.
  std::array<double, 3> volumes() const {
    std::vector<std::vector<std::uint32_t>> triangles(kLines);
    for (std::uint32_t t = 0; t < solid_.triangles.size(); ++t) {
      const auto [a, b, c] = corners(t);
      const int first = row_of(std::min({a.z, b.z, c.z})), last = row_of(std::max({a.z, b.z, c.z}));
      for (int row = std::max(first, 0); row <= std::min(last, kLines - 1); ++row)
        triangles[static_cast<std::size_t>(row)].push_back(t);
    }
    std::vector<std::array<double, 3>> sums(kLines);
    parallel_for(kLines, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t row = begin; row < end; ++row) {
        const double z = box_.low.z + (static_cast<double>(row) + kBeside) * width_.z;
        sums[row] = measure_row(z, triangles[row]);
      }
    });
    std::array<double, 3> whole{};
    for (const auto& sum : sums)
      for (std::size_t k = 0; k < 3; ++k) whole[k] += sum[k] * width_.y * width_.z;
    return whole;
  }

 private:
  // Lines go a little beside the middle, so that none meets the edges that modellers like.
  static constexpr double kBeside = 0.4872983346;

  int row_of(double z) const { return static_cast<int>(std::floor((z - box_.low.z) / width_.z)); }
  std::array<Vec3, 3> corners(std::uint32_t t) const {
    const auto [a, b, c] = solid_.triangles[t];
    return {solid_.vertices[a], solid_.vertices[b], solid_.vertices[c]};
  }

  std::array<double, 3> measure_row(double z, const std::vector<std::uint32_t>& triangles) const {
    std::vector<std::vector<double>> crossings(kLines);
    for (const std::uint32_t t : triangles) cross_row(corners(t), z, crossings);
    std::array<double, 3> sums{};
    Stretches solid, balls;
    for (std::size_t column = 0; column < kLines; ++column) {
      const double y = box_.low.y + (static_cast<double>(column) + kBeside) * width_.y;
      std::vector<double>& ends = crossings[column];
      std::ranges::sort(ends);
      solid.clear();
      for (std::size_t k = 1; k < ends.size(); k += 2) solid.push_back({ends[k - 1], ends[k]});
      balls.clear();
      for (const Sphere& s : spheres_) {
        const double dy = y - s.center.y, dz = z - s.center.z;
        const double half2 = s.radius * s.radius - dy * dy - dz * dz;
        if (half2 <= 0) continue;
        balls.push_back({s.center.x - std::sqrt(half2), s.center.x + std::sqrt(half2)});
      }
      join(balls);
      sums[0] += length(solid), sums[1] += length(balls), sums[2] += shared(solid, balls);
    }
    return sums;
  }

  // Adds where the lines of a row cross a triangle: between the two sides that the row's plane
  // cuts.
  void cross_row(const std::array<Vec3, 3>& triangle, double z,
                 std::vector<std::vector<double>>& crossings) const {
    std::array<Vec3, 2> ends;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      // From the lower end, so that neighbours find the same point.
      Vec3 a = triangle[k], b = triangle[(k + 1) % 3];
      if ((a.z < z) == (b.z < z)) continue;
      if (a.z > b.z) std::swap(a, b);
      if (count < 2) ends[count++] = a + ((z - a.z) / (b.z - a.z)) * (b - a);
    }
    if (count < 2) return;
    auto [a, b] = ends;
    if (a.y > b.y) std::swap(a, b);
    const auto column_after = [&](double y) {
      return static_cast<int>(std::ceil((y - box_.low.y) / width_.y - kBeside));
    };
    for (int k = std::max(column_after(a.y), 0); k < std::min(column_after(b.y), kLines); ++k) {
      const double y = box_.low.y + (k + kBeside) * width_.y;
      crossings[static_cast<std::size_t>(k)].push_back(a.x + (y - a.y) / (b.y - a.y) * (b.x - a.x));
    }
  }

  const Solid& solid_;
  const std::vector<Sphere>& spheres_;
  Box box_;
  Vec3 width_;  // distances between lines along y and z, m
};

}  // namespace

CoverShares cover_shares(const Solid& solid, const std::vector<Sphere>& spheres,
                         const Enclosure* enclosure) {
  std::optional<Enclosure> found;
  if (enclosure == nullptr) enclosure = &found.emplace(enclosure_of(solid));
  const auto [all, balls, both] =
      Lines(enclosure->surface ? *enclosure->surface : solid, spheres).volumes();
  // How many lines meet a face that lies along them is a matter of chance, for the solid and for
  // what both have alike; balls are round.
  const double covered = both / all;
  return {covered, std::max(0.0, balls / enclosure->volume - covered)};
}

}  // namespace vpm
