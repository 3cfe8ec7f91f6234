#include "tools/bench/voxel_greedy.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/mesh/triangle_bvh.h"
#include "libvpm/mesh/winding_number.h"

namespace vpm::bench {
namespace {

constexpr double kMargin = 1 - 1e-12;  // radii shrink, so that rounding makes no overlap
constexpr double kFirstStep = 0.5;     // of a compass search, in voxels
constexpr double kLastStep = 1e-6;     // in voxels
constexpr double kWalk = 2;            // farthest way of a compass search, in voxels

class VoxelGreedy {
 public:
  VoxelGreedy(const Solid& solid, int voxels)
      : bvh_(solid.vertices, solid.triangles), winding_(bvh_), low_(solid.vertices.front()) {
    Vec3 high = low_;
    for (const Vec3 p : solid.vertices) {
      low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y), std::min(low_.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const Vec3 side = high - low_;
    width_ = std::max({side.x, side.y, side.z}) / voxels;
    const auto count = [&](double length) { return static_cast<int>(std::ceil(length / width_)); };
    nx_ = std::max(1, count(side.x));
    ny_ = std::max(1, count(side.y));
    nz_ = std::max(1, count(side.z));
    room_.resize(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) *
                 static_cast<std::size_t>(nz_));
    const auto row = static_cast<std::size_t>(nx_);
    parallel_for(room_.size() / row, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin * row; v < end * row; ++v) {
        const Vec3 x = center(v);
        room_[v] = winding_.inside(x) ? static_cast<float>(bvh_.closest(x).distance) : 0;
      }
    });
  }

  std::vector<Sphere> run(std::size_t spheres, Refine refine) {
    std::priority_queue<std::pair<float, std::size_t>> queue;
    for (std::size_t v = 0; v < room_.size(); ++v)
      if (room_[v] > 0) queue.push({room_[v], v});
    while (placed_.size() < spheres && !queue.empty()) {
      const auto [room, v] = queue.top();
      queue.pop();
      if (room_[v] < room) {
        if (room_[v] > 0) queue.push({room_[v], v});
        continue;
      }
      gather(center(v), room);
      const Sphere found = refine == Refine::none ? Sphere{center(v), clearance(center(v))}
                                                  : compass_search(center(v));
      placed_.push_back({found.center, kMargin * found.radius});
      take(found, std::max<double>(room, found.radius));
    }
    return placed_;
  }

 private:
  Vec3 center(std::size_t v) const {
    const auto i = static_cast<int>(v % static_cast<std::size_t>(nx_));
    const auto jk = static_cast<int>(v / static_cast<std::size_t>(nx_));
    return low_ + width_ * Vec3{i + 0.5, jk % ny_ + 0.5, jk / ny_ + 0.5};
  }

  // The spheres that a search from x can meet.
  void gather(Vec3 x, double room) {
    near_.clear();
    for (const Sphere& s : placed_)
      if (norm(x - s.center) - s.radius < room + 2 * kWalk * width_) near_.push_back(s);
  }

  double clearance(Vec3 x) const {
    double d = bvh_.closest(x).distance;
    for (const Sphere& s : near_) d = std::min(d, norm(x - s.center) - s.radius);
    return d;
  }

  // Stays in the ball about the start that the mesh does not meet, so on its side.
  Sphere compass_search(Vec3 start) const {
    Sphere best{start, clearance(start)};
    const double walk = std::min(kWalk * width_, best.radius);
    for (double step = kFirstStep * width_; step > kLastStep * width_;) {
      bool better = false;
      for (int k = 0; k < 26; ++k) {
        const int code = k < 13 ? k : k + 1;  // all of 27 but the middle
        const Vec3 x =
            best.center + step * Vec3{code % 3 - 1.0, code / 3 % 3 - 1.0, code / 9 - 1.0};
        if (norm(x - start) > walk) continue;
        if (const double d = clearance(x); d > best.radius) {
          best = {x, d};
          better = true;
        }
      }
      if (!better) step /= 2;
    }
    return best;
  }

  // No voxel has more room than `most`.
  void take(const Sphere& s, double most) {
    const double around = s.radius + most;
    const auto range = [&](double at, double low, int count) {
      const auto index = [&](double x) {
        return static_cast<int>(std::clamp((x - low) / width_, 0.0, count - 1.0));
      };
      return std::pair{index(at - around), index(at + around)};
    };
    const auto [x0, x1] = range(s.center.x, low_.x, nx_);
    const auto [y0, y1] = range(s.center.y, low_.y, ny_);
    const auto [z0, z1] = range(s.center.z, low_.z, nz_);
    for (int z = z0; z <= z1; ++z) {
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const auto v = static_cast<std::size_t>((z * ny_ + y)) * static_cast<std::size_t>(nx_) +
                         static_cast<std::size_t>(x);
          const auto beside = static_cast<float>(norm(center(v) - s.center) - s.radius);
          room_[v] = std::min(room_[v], std::max(beside, 0.0f));
        }
      }
    }
  }

  TriangleBvh bvh_;
  WindingNumber winding_;
  Vec3 low_;
  double width_ = 0;
  int nx_ = 0, ny_ = 0, nz_ = 0;
  std::vector<float> room_;  // per voxel; 0 outside and where nothing fits
  std::vector<Sphere> placed_, near_;
};

}  // namespace

std::vector<Sphere> pack_on_voxels(const Solid& solid, std::size_t spheres, int voxels,
                                   Refine refine) {
  return VoxelGreedy(solid, voxels).run(spheres, refine);
}

}  // namespace vpm::bench
