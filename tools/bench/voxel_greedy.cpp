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

constexpr double kMargin = 1 - 1e-12;  // shrinks radii, so that rounding makes no overlap
constexpr double kFirstStep = 0.5;     // first step of a compass search, in voxels
constexpr double kLastStep = 1e-6;     // in voxels
constexpr double kWalk = 2;            // longest way of a compass search, in voxels

}  // namespace

struct VoxelGreedy::Field {
  Field(const Solid& solid, int voxels)
      : bvh(solid.vertices, solid.triangles), low(solid.vertices.front()) {
    Vec3 high = low;
    for (const Vec3 p : solid.vertices) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const Vec3 side = high - low;
    width = std::max({side.x, side.y, side.z}) / voxels;
    const auto count = [&](double length) { return static_cast<int>(std::ceil(length / width)); };
    nx = std::max(1, count(side.x));
    ny = std::max(1, count(side.y));
    nz = std::max(1, count(side.z));
    room.resize(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) *
                static_cast<std::size_t>(nz));
    const WindingNumber winding(bvh);
    const auto row = static_cast<std::size_t>(nx);
    parallel_for(room.size() / row, 4, [&](std::size_t begin, std::size_t end) {
      for (std::size_t v = begin * row; v < end * row; ++v) {
        const Vec3 x = center(v);
        room[v] = winding.inside(x) ? static_cast<float>(bvh.closest(x).distance) : 0;
      }
    });
  }

  Vec3 center(std::size_t v) const {
    const auto i = static_cast<int>(v % static_cast<std::size_t>(nx));
    const auto jk = static_cast<int>(v / static_cast<std::size_t>(nx));
    const int j = jk % ny, k = jk / ny;
    return low + width * Vec3{i + 0.5, j + 0.5, k + 0.5};
  }

  TriangleBvh bvh;
  Vec3 low;
  double width = 0;
  int nx = 0, ny = 0, nz = 0;
  std::vector<float> room;  // clearance per voxel; 0 outside
};

class VoxelGreedy::Run {
 public:
  explicit Run(const Field& field) : field_(field), room_(field.room) {}

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
      gather(field_.center(v), room);
      const Sphere found = refine == Refine::none
                               ? Sphere{field_.center(v), separation(field_.center(v))}
                               : compass_search(field_.center(v));
      placed_.push_back({found.center, kMargin * found.radius});
      take(found, std::max<double>(room, found.radius));
    }
    return placed_;
  }

 private:
  // Gathers the spheres that a search from x can meet.
  void gather(Vec3 x, double room) {
    near_.clear();
    for (const Sphere& s : placed_)
      if (norm(x - s.center) - s.radius < room + 2 * kWalk * field_.width) near_.push_back(s);
  }

  double separation(Vec3 x) const {
    double d = field_.bvh.closest(x).distance;
    for (const Sphere& s : near_) d = std::min(d, norm(x - s.center) - s.radius);
    return d;
  }

  // Searches within the ball about the start that the mesh does not meet, so on its side.
  Sphere compass_search(Vec3 start) const {
    Sphere best{start, separation(start)};
    const double walk = std::min(kWalk * field_.width, best.radius);
    for (double step = kFirstStep * field_.width; step > kLastStep * field_.width;) {
      bool better = false;
      for (int k = 0; k < 26; ++k) {
        const int code = k < 13 ? k : k + 1;  // skips the middle of the 27 directions
        const int i = code % 3 - 1, j = code / 3 % 3 - 1, l = code / 9 - 1;
        const Vec3 x = best.center + step * Vec3{1.0 * i, 1.0 * j, 1.0 * l};
        if (norm(x - start) > walk) continue;
        if (const double d = separation(x); d > best.radius) {
          best = {x, d};
          better = true;
        }
      }
      if (!better) step /= 2;
    }
    return best;
  }

  // Adds a sphere and lowers the clearance around it. No voxel has more clearance than `most`.
  void take(const Sphere& s, double most) {
    const double around = s.radius + most;
    const auto range = [&](double at, double low, int count) {
      const auto index = [&](double x) {
        return static_cast<int>(std::clamp((x - low) / field_.width, 0.0, count - 1.0));
      };
      return std::pair{index(at - around), index(at + around)};
    };
    const auto [x0, x1] = range(s.center.x, field_.low.x, field_.nx);
    const auto [y0, y1] = range(s.center.y, field_.low.y, field_.ny);
    const auto [z0, z1] = range(s.center.z, field_.low.z, field_.nz);
    for (int z = z0; z <= z1; ++z) {
      for (int y = y0; y <= y1; ++y) {
        for (int x = x0; x <= x1; ++x) {
          const auto v =
              static_cast<std::size_t>((z * field_.ny + y)) * static_cast<std::size_t>(field_.nx) +
              static_cast<std::size_t>(x);
          const auto beside = static_cast<float>(norm(field_.center(v) - s.center) - s.radius);
          room_[v] = std::min(room_[v], std::max(beside, 0.0f));
        }
      }
    }
  }

  const Field& field_;
  std::vector<float> room_;  // per voxel; 0 outside and where nothing fits
  std::vector<Sphere> placed_, near_;
};

VoxelGreedy::VoxelGreedy(const Solid& solid, int voxels)
    : field_(std::make_unique<Field>(solid, voxels)) {}

VoxelGreedy::~VoxelGreedy() = default;

std::vector<Sphere> VoxelGreedy::pack(std::size_t spheres, Refine refine) const {
  return Run(*field_).run(spheres, refine);
}

}  // namespace vpm::bench
