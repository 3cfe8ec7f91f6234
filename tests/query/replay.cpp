#include "tests/query/replay.h"

#include <cmath>
#include <cstdint>
#include <span>

#include "libvpm/cloud/normals.h"
#include "libvpm/cloud/scattered_points.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/lattice_model.h"

namespace vpm::testing {
namespace {

constexpr int kPosesPerPath = 84;  // 3 scenes, 2 kinds of cloud, 2 tools, 2 measures: 2016 queries

class Numbers {  // SplitMix64
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed) {}
  double between(double low, double high) {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15ULL;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ z >> 27) * 0x94d049bb133111ebULL;
    return low + (high - low) * (static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53);
  }

 private:
  std::uint64_t state_;
};

class Bytes {
 public:
  template <class T>
  void add(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    all_.insert(all_.end(), bytes.begin(), bytes.end());
  }
  void add(const Result& r) {
    const Wrench& w = r.wrench;
    add(std::vector<double>{r.volume, r.volume_fraction, w.force.x, w.force.y, w.force.z,
                            w.torque.x, w.torque.y, w.torque.z});
    add(std::vector<std::uint32_t>{r.boundary, r.inside, r.points.value_or(0)});
  }
  std::vector<std::byte> take() { return std::move(all_); }

 private:
  std::vector<std::byte> all_;
};

Camera camera() {
  Camera camera;
  camera.intrinsics = {131.25, 131.25, 79.5, 59.5};
  camera.width = 160;
  camera.height = 120;
  camera.to_world.translation = {1e3, -2e3, 0.5e3};
  return camera;
}

// Returns the surfaces in front of the camera, touched at a depth of 1 m.
std::vector<synthetic::SurfacePtr> surfaces(Vec3 at) {
  return {synthetic::make_wall(at + Vec3{0, 0, 1}, {0.36, 0.48, -0.8}),
          synthetic::make_inverted_ball(at + Vec3{0, 0, 0.7}, 0.3),
          synthetic::make_ball(at + Vec3{0, 0, 1.25}, 0.25)};
}

// Adds errors of a third of a per cent and loses one pixel in a hundred.
DepthImage spoiled(DepthImage image, Numbers& numbers) {
  for (float& depth : image.depth) {
    depth *= static_cast<float>(numbers.between(0.997, 1.003));
    if (numbers.between(0, 1) < 0.01) depth = 0;
  }
  return image;
}

Cloud scattered(const Cloud& cloud) {
  std::vector<Vec3> positions, normals;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    positions.push_back(cloud.origin + widen(cloud.positions[i]));
    normals.push_back(widen(cloud.normals[i]));
  }
  return cloud_of_scattered_points(positions, normals, {}, "replay");
}

Pose pose(Numbers& numbers, Vec3 at) {
  Quaternion q;
  double squared = 0;
  do {
    q = {numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(-1, 1),
         numbers.between(-1, 1)};
    squared = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  } while (squared < 0.01 || squared > 1);
  const double length = std::sqrt(squared);
  return {rotation_from_quaternion({q.x / length, q.y / length, q.z / length, q.w / length}),
          at + Vec3{numbers.between(-0.1, 0.1), numbers.between(-0.1, 0.1),
                    numbers.between(0.85, 1.1)}};
}

void run_path(const ToolModel& tool, const AnyBody& cloud, Measure measure, const Device& device,
              Vec3 at, Numbers& numbers, Bytes& bytes) {
  QueryOptions options;
  options.measure = measure;
  options.device = device_for(measure, device);
  ToolQuery query(tool, options);
  for (int k = 0; k < kPosesPerPath; ++k) {
    bytes.add(query.run(cloud, pose(numbers, at)));
    bytes.add(std::vector<SphereState>(query.states().begin(), query.states().end()));
  }
}

void add_cloud(const Cloud& cloud, Bytes& bytes) {
  bytes.add(cloud.positions);
  bytes.add(cloud.normals);
  bytes.add(cloud.radii);
}

}  // namespace

std::vector<std::byte> replay(const Device& device) {
  Bytes bytes;
  Numbers numbers(1);
  const Camera view = camera();
  const Vec3 at = view.to_world.translation;
  const ToolModel tools[] = {lattice_cube(0.2, 7, 2), lattice_cube(0.16, 4, 5)};
  NormalOptions pca;
  pca.method = NormalMethod::pca;
  for (const synthetic::SurfacePtr& surface : surfaces(at)) {
    const DepthImage image = spoiled(synthetic::render(*surface, view), numbers);
    const Cloud seen = make_cloud(image, view, {});
    const Cloud points = scattered(make_cloud(image, view, pca));
    for (const Cloud& cloud : {seen, points}) {
      add_cloud(cloud, bytes);
      const AnyBody prepared(cloud);
      for (const ToolModel& tool : tools) {
        for (const Measure measure : {Measure::refined, Measure::paper})
          run_path(tool, prepared, measure, device, at, numbers, bytes);
      }
    }
  }
  return bytes.take();
}

}  // namespace vpm::testing
