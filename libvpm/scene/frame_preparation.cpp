#include "libvpm/scene/frame_preparation.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <numeric>

#include "libvpm/cloud/padded_image.h"
#include "libvpm/core/lanes.h"
#include "libvpm/core/lengths.h"

namespace vpm {
namespace {

// How far rounding moves the squared length of a unit normal at most; validate() allows more.
constexpr double kUnitTolerance = 1.9e-3;

bool is_of_size(const DepthImage& depth, const Camera& camera) {
  return depth.width == camera.width && depth.height == camera.height && !depth.depth.empty() &&
         depth.depth.size() == std::size_t{depth.width} * depth.height;
}

// Describes a row of the frame: its inputs, and where each pixel's point goes.
struct RowOfPoints {
  int width;
  double ray_y;
  Rotation to_world, to_camera;
  const float* depth;
  const NormalRow& seen;
  const double* ray_x;
  Vec3f *positions, *normals;
  float *back_x, *back_y, *back_z;  // normals in camera axes
  std::uint8_t* exists;
};

struct RowFacts {
  std::uint32_t points = 0;
  bool is_sound = true;
};

[[gnu::always_inline]] inline void place_tile(const RowOfPoints& row, int first, RowFacts& facts) {
  const int count = std::min(kTile, row.width - first);
  const Rotation to_world = row.to_world, to_camera = row.to_camera;
  const double ray_y = row.ray_y;
  float depth[kTile] = {};
  std::copy(row.depth + first, row.depth + first + count, depth);
  const float *nx = row.seen.x.data() + first, *ny = row.seen.y.data() + first,
              *nz = row.seen.z.data() + first;
  const double* ray_x = row.ray_x + first;
  VectorTile position, normal, back;
  std::uint32_t exists[kTile], points = 0, odd = 0;
  for (int i = 0; i < kTile; ++i) {
    const double z = depth[i];
    const Vec3f p = narrow(to_world * point_on_ray(ray_x[i], ray_y, z));
    const Vec3f n = narrow(to_world * Vec3{nx[i], ny[i], nz[i]});
    const Vec3f b = narrow(to_camera * widen(n));
    const double off = squared_norm(widen(n)) - 1;
    const bool there = (nx[i] != 0) | (ny[i] != 0) | (nz[i] != 0);
    position.x[i] = p.x, position.y[i] = p.y, position.z[i] = p.z;
    normal.x[i] = n.x, normal.y[i] = n.y, normal.z[i] = n.z;
    back.x[i] = there ? b.x : 0, back.y[i] = there ? b.y : 0, back.z[i] = there ? b.z : 0;
    exists[i] = there;
    odd |= there & !((off <= kUnitTolerance) & (off >= -kUnitTolerance));
  }
  for (int i = 0; i < kTile; ++i) points += exists[i];
  facts.points += points;
  facts.is_sound = facts.is_sound && odd == 0;
  position.store(count, row.positions + first);
  normal.store(count, row.normals + first);
  std::copy(back.x, back.x + count, row.back_x + first);
  std::copy(back.y, back.y + count, row.back_y + first);
  std::copy(back.z, back.z + count, row.back_z + first);
  std::copy(exists, exists + count, row.exists + first);
}

VPM_VECTOR_CLONES
RowFacts place_row(const RowOfPoints& row) {
  RowFacts facts;
  for (int first = 0; first < row.width; first += kTile) place_tile(row, first, facts);
  return facts;
}

// Removes pixels without a point, and writes for each pixel the first point from there on.
void compact_row(const std::uint8_t* exists, int width, std::uint32_t first, Vec3f* positions,
                 Vec3f* normals, std::uint32_t* begin) {
  std::uint32_t k = 0;
  for (int u = 0; u < width; ++u) {
    begin[u] = first + k;
    positions[k] = positions[u];
    normals[k] = normals[u];
    k += exists[u];
  }
}

}  // namespace

FramePreparation::FramePreparation(const NormalOptions& options, Denoising points)
    : options_(options), points_(points) {
  check_normal_options(options);
}

void FramePreparation::prepare(const DepthImage& depth, const Camera& camera,
                               PreparedImage& image) {
  try {
    check_intrinsics(camera.intrinsics);
    if (!is_of_size(depth, camera) || !is_usual(camera) ||
        !is_in_range(camera.to_world.translation) || !prepare_rows(depth, camera, image))
      image = PreparedImage(make_cloud(depth, camera, options_), points_);  // may throw
  } catch (...) {
    image = {};
    throw;
  }
}

// Gives the image the frame's camera and room for a point in each pixel.
void FramePreparation::take_camera(const Camera& camera, PreparedImage& image) {
  const std::size_t width = camera.width, pixels = width * camera.height;
  image.serial_ = next_serial();
  image.points_.origin = camera.to_world.translation;
  image.camera_ = camera;
  image.points_.positions.resize(pixels);
  image.points_.normals.resize(pixels);
  image.pixel_begin_.resize(pixels + 1);
  row_points_.resize(camera.height);
  rays_.resize(width + kTile);
  for (std::size_t u = 0; u < width; ++u)
    rays_[u] = (static_cast<double>(u) - camera.intrinsics.cx) / camera.intrinsics.fx;
}

// Returns false if a normal is not sound.
bool FramePreparation::prepare_rows(const DepthImage& depth, const Camera& camera,
                                    PreparedImage& image) {
  validate(camera, "the cloud");
  const std::size_t width = depth.width;
  const Intrinsics& k = camera.intrinsics;
  const Rotation to_camera =
      relative_to(camera.to_world, {{}, camera.to_world.translation}).rotation;
  take_camera(camera, image);
  images_.resize(depth.width, depth.height, options_);
  steps_.resize(depth.width, depth.height);
  SeenImage& seen = steps_.seen();
  const auto take = [&](int begin, int end) {
    images_.take_rows(depth, options_, begin, end);
    for (int v = begin; v < end; ++v)
      std::copy_n(images_.inverse.at(0, v), width, seen.inverse.at(0, v));
    seen.take_removed(depth, begin, end);
  };
  std::atomic<bool> is_sound{true};
  const auto find = [&](int begin, int end, const auto& made) {
    NormalBand band(images_, k, options_);
    std::vector<std::uint8_t> exists(width);
    for (int v = begin; v < end; ++v) {
      const NormalRow& row = band.estimate(v);
      const std::size_t at = static_cast<std::size_t>(v) * width;
      Vec3f *positions = image.points_.positions.data() + at,
            *normals = image.points_.normals.data() + at;
      const auto [points, sound] =
          place_row({static_cast<int>(width), (v - k.cy) / k.fy, camera.to_world.rotation,
                     to_camera, depth.depth.data() + at, row, rays_.data(), positions, normals,
                     seen.x.at(0, v), seen.y.at(0, v), seen.z.at(0, v), exists.data()});
      if (!sound) is_sound = false;
      row_points_[static_cast<std::size_t>(v)] = points;
      std::uint32_t* pixel_begin = image.pixel_begin_.data() + at;
      if (points < width)
        compact_row(exists.data(), static_cast<int>(width), static_cast<std::uint32_t>(at),
                    positions, normals, pixel_begin);
      else
        std::iota(pixel_begin, pixel_begin + width, static_cast<std::uint32_t>(at));
      made(v);
    }
  };
  steps_.make(points_, take, find, image.image_);
  close_ranks(width, image);
  return is_sound;
}

// Moves each row's points from its first pixel to behind those of the row above.
void FramePreparation::close_ranks(std::size_t width, PreparedImage& image) const {
  std::uint32_t first = 0;
  for (std::size_t v = 0; v < row_points_.size(); ++v) {
    const auto at = static_cast<std::uint32_t>(v * width);
    if (first < at) {
      const auto move = [&](std::vector<Vec3f>& points) {
        std::memmove(points.data() + first, points.data() + at, row_points_[v] * sizeof(Vec3f));
      };
      move(image.points_.positions);
      move(image.points_.normals);
      for (std::size_t u = 0; u < width; ++u) image.pixel_begin_[at + u] -= at - first;
    }
    first += row_points_[v];
  }
  image.pixel_begin_.back() = first;
  image.points_.positions.resize(first);
  image.points_.normals.resize(first);
}

}  // namespace vpm
