#include "tools/bench/smooth_solids.h"

#include <cmath>
#include <utility>

#include "libvpm/model/sphere.h"
#include "libvpm/synthetic/shapes.h"

namespace vpm::bench {
namespace {

// Returns -1, 0 or 1; 0 for what is 0 but for rounding.
double sign_of(double v) {
  return std::abs(v) < 1e-9 ? 0 : std::copysign(1, v);
}

// Moves each vertex of a ball of radius 1 m to where `map` puts it.
template <typename Map>
Solid mapped(Solid ball, Map map) {
  for (Vec3& v : ball.vertices) v = map(v);
  return ball;
}

// Returns a ball of radius 1 m made of meridians and parallels, with triangles that narrow towards
// its poles on the z axis.
Solid ball_of_meridians(std::uint32_t meridians, std::uint32_t parallels) {
  Solid ball;
  ball.vertices = {{0, 0, 1}, {0, 0, -1}};
  for (std::uint32_t i = 1; i <= parallels; ++i) {
    for (std::uint32_t j = 0; j < meridians; ++j) {
      const double down = kPi * i / (parallels + 1), around = 2 * kPi * j / meridians;
      ball.vertices.push_back(
          {std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) {
    return 2 + i * meridians + j % meridians;
  };
  for (std::uint32_t j = 0; j < meridians; ++j) {
    ball.triangles.push_back({0, at(0, j), at(0, j + 1)});
    ball.triangles.push_back({1, at(parallels - 1, j + 1), at(parallels - 1, j)});
    for (std::uint32_t i = 0; i + 1 < parallels; ++i) {
      ball.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      ball.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return ball;
}

// Maps a unit vector to the surface of a lens: what two balls of radius 2 m have in common that
// meet in a rim 0.6 rad from their poles.
Vec3 to_lens(Vec3 v) {
  constexpr double kRadius = 2, kRim = 0.6;
  const double from_axis = std::hypot(v.x, v.y);
  const double angle = kRim * std::atan2(from_axis, std::abs(v.z)) / (kPi / 2);
  const double wider = from_axis > 1e-12 ? kRadius * std::sin(angle) / from_axis : 0;
  const double height = kRadius * (std::cos(angle) - std::cos(kRim));
  return {wider * v.x, wider * v.y, sign_of(v.z) * height};
}

}  // namespace

std::vector<SmoothSolid> smooth_solids(bool quick) {
  const Solid ball = synthetic::make_icosphere(1, quick ? 4 : 6);
  const auto capsule = [](Vec3 v) { return Vec3{v.x, v.y, v.z + sign_of(v.z)}; };
  if (quick) return {{"capsule", mapped(ball, capsule)}, {"ball", ball}};
  const auto near_ball = [](Vec3 v) { return Vec3{v.x, 0.999 * v.y, 0.998 * v.z}; };
  const auto egg = [](Vec3 v) { return Vec3{v.x, v.y, v.z > 0 ? 1.4 * v.z : v.z}; };
  const auto box = [](Vec3 v) {
    return 0.2 * v + Vec3{0.5 * sign_of(v.x), 0.4 * sign_of(v.y), 0.3 * sign_of(v.z)};
  };
  return {{"capsule", mapped(ball, capsule)},
          {"ball", synthetic::make_icosphere(1, 4)},
          {"ball", synthetic::make_icosphere(1, 5)},
          {"ball", ball},
          {"ball of meridians", ball_of_meridians(288, 143)},
          {"nearly a ball", mapped(ball, near_ball)},
          {"egg", mapped(ball, egg)},
          {"lens", mapped(ball_of_meridians(400, 99), to_lens)},
          {"rounded box", mapped(ball, box)}};
}

}  // namespace vpm::bench
