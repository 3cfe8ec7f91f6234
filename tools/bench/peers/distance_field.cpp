#include "tools/bench/peers/distance_field.h"

#include <cstdint>

#include "libvpm/core/parallel.h"
#include "libvpm/core/pose.h"

namespace vpm::bench {
namespace {

// Voxels by which a place may lie beside a surfel and be measured along its normal.
constexpr double kBeside = 2;

// Distance of a place from a surfel: along its normal beside it, else straight.
double signed_distance(Vec3 place, Vec3 point, Vec3 normal, double voxel) {
  const Vec3 from = place - point;
  const double along = dot(from, normal), squared = squared_norm(from);
  const double beside = kBeside * voxel;
  if (squared - along * along <= beside * beside) return along;
  return std::copysign(std::sqrt(squared), along);
}

// Says whether a camera sees a place clearly before the surface.
bool is_seen_free(const CloudSensor& sensor, Vec3 place, double margin) {
  const Camera& camera = sensor.camera;
  const Vec3 at = inverse(camera.to_world) * place;
  const double u = camera.intrinsics.fx * at.x / at.z + camera.intrinsics.cx + .5,
               v = camera.intrinsics.fy * at.y / at.z + camera.intrinsics.cy + .5;
  if (!(at.z > 0 && u >= 0 && v >= 0 && u < camera.width && v < camera.height)) return false;
  const float depth =
      sensor.depth
          .depth[sensor.depth.index(static_cast<std::uint32_t>(u), static_cast<std::uint32_t>(v))];
  return is_measured(depth) && at.z + margin < depth;
}

}  // namespace

std::array<int, 3> DistanceField::count_of(const Box& box, double voxel) {
  const auto samples = [&](double side) { return static_cast<int>(std::ceil(side / voxel)) + 2; };
  const Vec3 size = box.size();
  return {samples(size.x), samples(size.y), samples(size.z)};
}

std::size_t DistanceField::bytes_of(const Box& box, double voxel) {
  std::size_t bytes = sizeof(float);
  for (const int count : count_of(box, voxel)) bytes *= static_cast<std::size_t>(count);
  return bytes;
}

DistanceField::DistanceField(const Box& box, double voxel)
    : low_(box.low), voxel_(voxel), count_(count_of(box, voxel)) {
  row_ = count_[0];
  layer_ = row_ * count_[1];
  samples_.resize(static_cast<std::size_t>(layer_) * static_cast<std::size_t>(count_[2]));
}

DistanceField::DistanceField(const Box& box, double voxel,
                             const std::function<double(Vec3)>& distance)
    : DistanceField(box, voxel) {
  const auto layers = [&](std::size_t begin, std::size_t end) {
    for (int k = static_cast<int>(begin); k < static_cast<int>(end); ++k)
      for (int j = 0; j < count_[1]; ++j)
        for (int i = 0; i < count_[0]; ++i)
          samples_[index(i, j, k)] = static_cast<float>(distance(place(i, j, k)));
  };
  parallel_for(static_cast<std::size_t>(count_[2]), 1, layers);
}

// The surfels of a cloud, and for each sample the nearest that is known so far.
struct DistanceField::Nearest {
  // The mean of a voxel's points, and of their normals.
  struct Surfel {
    Vec3 point, normal;
    double points = 0;
  };
  static constexpr std::uint32_t kNone = 0xffffffffU;
  std::vector<Surfel> surfels;
  std::vector<std::uint32_t> of_sample;
};

DistanceField::Nearest DistanceField::surfels_of(const Cloud& cloud) const {
  Nearest nearest{{}, std::vector<std::uint32_t>(samples_.size(), Nearest::kNone)};
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    const Vec3 point = cloud.origin + widen(cloud.positions[p]), at = (point - low_) / voxel_;
    const int i = static_cast<int>(std::lround(at.x)), j = static_cast<int>(std::lround(at.y)),
              k = static_cast<int>(std::lround(at.z));
    if (i < 0 || j < 0 || k < 0 || i >= count_[0] || j >= count_[1] || k >= count_[2]) continue;
    std::uint32_t& here = nearest.of_sample[index(i, j, k)];
    if (here == Nearest::kNone) {
      here = static_cast<std::uint32_t>(nearest.surfels.size());
      nearest.surfels.emplace_back();
    }
    Nearest::Surfel& surfel = nearest.surfels[here];
    surfel.point += point, surfel.normal += widen(cloud.normals[p]), surfel.points += 1;
  }
  for (Nearest::Surfel& s : nearest.surfels)
    s.point = s.point / s.points, s.normal = normalized_or_zero(s.normal);
  return nearest;
}

// Goes through the samples along the diagonal (si, sj, sk), each of which takes over the surfels of
// the three samples before it where they are nearer.
void DistanceField::sweep(int si, int sj, int sk, Nearest& nearest) const {
  const auto [nx, ny, nz] = count_;
  for (int c = 0; c < nz; ++c)
    for (int b = 0; b < ny; ++b)
      for (int a = 0; a < nx; ++a) {
        const int i = si > 0 ? a : nx - 1 - a, j = sj > 0 ? b : ny - 1 - b,
                  k = sk > 0 ? c : nz - 1 - c;
        std::uint32_t& here = nearest.of_sample[index(i, j, k)];
        const Vec3 x = place(i, j, k);
        const auto squared = [&](std::uint32_t s) {
          return s == Nearest::kNone ? HUGE_VAL : squared_norm(x - nearest.surfels[s].point);
        };
        double least = squared(here);
        const auto take = [&](bool is_there, int i2, int j2, int k2) {
          if (!is_there) return;
          const std::uint32_t other = nearest.of_sample[index(i2, j2, k2)];
          if (other == here) return;
          if (const double of_other = squared(other); of_other < least)
            least = of_other, here = other;
        };
        take(a > 0, i - si, j, k);
        take(b > 0, i, j - sj, k);
        take(c > 0, i, j, k - sk);
      }
}

DistanceField DistanceField::of_points(const Cloud& cloud, const Box& box, double voxel) {
  DistanceField field(box, voxel);
  Nearest nearest = field.surfels_of(cloud);
  for (const int sk : {1, -1})
    for (const int sj : {1, -1})
      for (const int si : {1, -1}) field.sweep(si, sj, sk, nearest);
  for (int k = 0; k < field.count_[2]; ++k)
    for (int j = 0; j < field.count_[1]; ++j)
      for (int i = 0; i < field.count_[0]; ++i) {
        const std::uint32_t s = nearest.of_sample[field.index(i, j, k)];
        const Vec3 x = field.place(i, j, k);
        const bool is_near = s != Nearest::kNone;
        const Nearest::Surfel of = is_near ? nearest.surfels[s] : Nearest::Surfel{};
        double distance = is_near ? signed_distance(x, of.point, of.normal, voxel) : HUGE_VAL;
        if (distance < 0 && cloud.sensor && is_seen_free(*cloud.sensor, x, kBeside * voxel))
          distance = norm(x - of.point);
        field.samples_[field.index(i, j, k)] = static_cast<float>(distance);
      }
  return field;
}

DistanceField::ToVoxels DistanceField::to_voxels(const Pose& pose) const {
  const double scale = 1 / voxel_;
  return {narrow(scale * pose.rotation.row0), narrow(scale * pose.rotation.row1),
          narrow(scale * pose.rotation.row2), narrow(scale * (pose.translation - low_))};
}

std::vector<Vec3f> DistanceField::places_inside() const {
  std::vector<Vec3f> places;
  for (int k = 0; k < count_[2]; ++k)
    for (int j = 0; j < count_[1]; ++j)
      for (int i = 0; i < count_[0]; ++i)
        if (samples_[index(i, j, k)] < 0) places.push_back(narrow(place(i, j, k)));
  return places;
}

}  // namespace vpm::bench
