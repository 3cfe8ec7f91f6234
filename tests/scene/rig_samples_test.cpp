// Places that several cameras are asked about together get what each gets alone.

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/ring_of_cameras.h"
#include "tests/query/samples_beside_faces.h"
#include "tests/scene/rig_scenes.h"

namespace vpm {
namespace {

using testing::Draws;
using testing::expect_same_bits;
using testing::make_holes;
using testing::places;
using testing::ring_of_cameras;
using testing::room_with;
using testing::scene;
using testing::with_faces;

// Counts samples of which is told only that they are wholly behind the surface, by less than
// `deepest`, m, and those that are deeper.
struct Told {
  int only_side = 0, deeper = 0;
};
// Expects of samples at a pose in the rig's frame what is told of each of them alone.
void expect_samples_of_each(const RigSurface::View& view, const Pose& to_rig,
                            std::span<const CellSample> samples, const SampleFaces& faces,
                            double deepest, Told& told) {
  std::vector<SurfaceOfSample> reached(samples.size());
  const std::uint32_t wanted =
      sample_surface(view, to_rig, samples, faces, deepest, reached.data());
  std::uint32_t next = 0;
  for (std::uint32_t k = 0; k < samples.size(); ++k) {
    const PieceShape shape = shape_of(samples[k], faces);
    const double radius = shape.radius;
    const SurfaceSample alone = view.sample_within(to_rig * widen(samples[k].center), radius);
    const bool is_left_out = next == wanted || reached[next].sample != k;
    EXPECT_EQ(is_left_out,
              alone.known && side_of_piece(TurnedShape{shape, to_rig.rotation}, alone.distance,
                                           alone.normal) == PlaneSide::before)
        << k;
    if (is_left_out) continue;
    const Vec3 x = reached[next].at.x;
    const SurfaceSample& found = reached[next++].at.on_surface;
    if (is_behind_surface(alone)) {
      EXPECT_EQ(view.rig->closest_normal(x, found), view.rig->closest_normal(x, alone)) << k;
    }
    told.deeper += is_behind_surface(alone) && alone.distance < -deepest;
    if (found.known && squared_norm(found.normal) == 0) {
      EXPECT_TRUE(alone.known && alone.distance <= -radius && alone.distance >= -deepest) << k;
      EXPECT_TRUE(found.distance <= -radius && found.distance >= -deepest) << k;
      ++told.only_side;
    } else {
      expect_same_bits(alone, found, static_cast<int>(k));
    }
  }
}

// Lanes must not tell each other anything: some places are in a hole of one camera, or out of its
// view, where others are not.
TEST(RigOfAnyScene, PlacesTogetherHaveTheBitsOfEachAlone) {
  std::vector<DepthBody> images;
  for (Camera camera : ring_of_cameras(3)) {
    camera.intrinsics = {131, 131, 79.5, 59.5};
    camera.width = 160, camera.height = 120;
    DepthImage image = synthetic::render(*scene(), camera);
    for (std::uint32_t k = 0; k < image.depth.size(); ++k)
      if (!images.empty() && k % image.width % 16 < 6 && k / image.width % 16 < 6)
        image.depth[k] = 0;
    images.emplace_back(make_cloud(image, camera, {}));
  }
  const RigBody body(std::move(images));
  const RigSurface surface = body.surface();
  const Pose to_rig = inverse(body.to_world());
  Told told;
  const std::vector<Vec3> all = places(400000, 0.3);
  for (std::size_t k = 0; k + 4 <= all.size(); k += 4) {
    const Vec3 four[] = {to_rig * all[k], to_rig * all[k + 1], to_rig * all[k + 2],
                         to_rig * all[k + 3]};
    for (const CameraSet some : {CameraSet{7}, CameraSet{1}, CameraSet{6}, CameraSet{5}}) {
      SurfaceSample lanes[4];
      sample_four(RigSurface::View{&surface, some}, four, lanes);
      PlaceSample known[4];
      std::size_t count = 0;
      for (int lane = 0; lane < 4; ++lane) {
        const SurfaceSample alone = surface.sample(four[lane], some);
        expect_same_bits(alone, lanes[lane], static_cast<int>(k) + lane);
        if (alone.known && alone.distance < 0) known[count++] = {four[lane], alone};
      }
      // Those that are left out are before the surface, further than they reach.
      CellSample samples[4];
      for (int lane = 0; lane < 4; ++lane)
        samples[lane] = {narrow(four[lane]), 0.01F * static_cast<float>(1 + k % 5), 1};
      expect_samples_of_each({&surface, some}, {}, samples, {}, HUGE_VAL, told);
      if (count == 0) continue;
      Vec3 normals[4];
      closest_normals(surface, {known, count}, normals);
      for (std::size_t i = 0; i < count; ++i)
        EXPECT_EQ(surface.closest_normal(known[i].x, known[i].on_surface), normals[i]) << k;
    }
  }
}

// Returns images of so many cameras, with holes, noise and wrong poses, and pixels of any shape.
RigBody any_rig(int count, std::uint32_t seed) {
  std::vector<DepthBody> images;
  const Rotation turned =
      rotation_from_vector({0.4 * std::sin(3.1 * seed), 0.9 * std::sin(1.7 * seed), 0.5 * seed});
  const synthetic::SurfacePtr surface =
      room_with(synthetic::make_block({0.24, 0.18, 0.05 + 0.05 * (seed % 4)}, {turned, {}}));
  for (Camera camera : ring_of_cameras(count)) {
    camera = testing::with_larger_pixels(camera, 2 + seed % 2, 2 + seed / 2 % 2);
    const auto k = static_cast<std::uint32_t>(images.size());
    DepthImage image = seed % 2 == 0 ? synthetic::render(*surface, camera)
                                     : synthetic::render_with_kinect_noise(*surface, camera, k);
    if (seed % 3 == 1) make_holes(image, seed + k);
    if (seed % 4 > 1) camera.to_world.translation += 0.004 * Vec3{std::sin(k), std::cos(seed), 0};
    images.emplace_back(make_cloud(image, camera, {}));
  }
  return RigBody(std::move(images));
}

// Of most places of a block it is enough to know on which side they are. What is told of the others
// has the bits of each alone.
TEST(RigOfAnyScene, SamplesOfABlockAreThoseOfEachAlone) {
  Told told;
  Draws numbers;
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const RigBody rig = any_rig(2 + static_cast<int>(seed % 4), seed);
    const RigSurface surface = rig.surface();
    const std::vector<Vec3> centers = places(1500, 0.2), offsets = places(16, 1);
    for (std::size_t k = 0; k < centers.size(); ++k) {
      const double size = 0.002 + 0.02 * std::abs(std::sin(4.1 * static_cast<double>(k)));
      const Vec3 center = inverse(rig.to_world()) * centers[k];
      Level level;
      for (const Vec3& offset : offsets)
        level.samples.push_back({narrow(0.6 * size * offset), static_cast<float>(0.2 * size), 1});
      const auto& [samples, rows] = with_faces(numbers, level);
      const double deepest = k % 2 == 0 ? HUGE_VAL : 0.04;
      expect_samples_of_each({&surface, surface.all_cameras()},
                             {rotation_from_vector(numbers.place(2)), center}, samples,
                             {rows.data()}, deepest, told);
    }
  }
  EXPECT_GT(told.only_side, 2000);
  EXPECT_GT(told.deeper, 500);
}

}  // namespace
}  // namespace vpm
