// What a camera knows of a tool: seen free, unseen and out of view, beside the volume.

#include <gtest/gtest.h>
#include <vpm/query_types.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/backend/cpu/measure_refined.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/core/parallel.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/expect_equal.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

using testing::generic_rotation;
using testing::lattice_cube;

constexpr double kLatticeEdge = 0.2;

double sum_of(const Result& r) {
  return r.volume_fraction + r.visibility->seen_free + r.visibility->unseen +
         r.visibility->out_of_view;
}

// Counts places of the tool by what is known of them.
struct Known {
  double volume = 0, seen_free = 0, unseen = 0, out_of_view = 0;
};

// Returns what is known of places before testing::wall_with_hole(). Behind the wall they count if
// they are no further than the tool's radius, or the wall cuts the tool.
Known known_of(const std::vector<Vec3>& places, const Camera& camera, const Pose& pose,
               double radius, bool is_cut) {
  const Intrinsics& k = camera.intrinsics;
  Known known;
  const double each = 1 / static_cast<double>(places.size());
  for (const Vec3& place : places) {
    const Vec3 x = pose * place;
    const double u = k.fx * x.x / x.z + k.cx, v = k.fy * x.y / x.z + k.cy;
    const bool in_view =
        x.z > 0 && u >= -0.5 && v >= -0.5 && u < camera.width - 0.5 && v < camera.height - 0.5;
    if (!in_view)
      known.out_of_view += each;
    else if (testing::kHoleAcross.holds(u) && testing::kHoleDown.holds(v))
      known.unseen += each;
    else if (x.z < 1)
      known.seen_free += each;
    else if (x.z < 1 + radius || is_cut)
      known.volume += each;
    else
      known.unseen += each;
  }
  return known;
}

// The bound is that of the cells, which are a tenth of the tool wide: half a layer of them on the
// rim of the hole or of the image may be on the wrong side.
TEST(Visibility, IsThatOfTheToolsPlaces) {
  constexpr double kSmall = 0.14;  // the tool fits between the rims
  const Cloud cloud = testing::wall_with_hole();
  const AnyBody wall(cloud);
  const std::vector<Vec3> places = testing::places_in_cube(kSmall, 30);
  Known most;
  for (const ToolModel& tool : {lattice_cube(kSmall, 10, 3), lattice_cube(kSmall, 5, 6)}) {
    ToolQuery query(tool, {});
    for (const double z : {0.0, 0.5, 0.8, 1.0, 1.08, 1.2, 1.6}) {
      for (double x = -0.9; x < 0.9; x += 0.06) {
        SCOPED_TRACE(::testing::Message() << x << ' ' << z);
        const Pose pose{generic_rotation(), {x, 0.02, z}};
        const Result r = query.run(wall, pose);
        const Known expected =
            known_of(places, cloud.sensor->camera, pose, tool.radius, r.boundary > 0);
        ASSERT_TRUE(r.visibility);
        EXPECT_NEAR(r.volume_fraction, expected.volume, 0.04);
        EXPECT_NEAR(r.visibility->seen_free, expected.seen_free, 0.04);
        EXPECT_NEAR(r.visibility->unseen, expected.unseen, 0.04);
        EXPECT_NEAR(r.visibility->out_of_view, expected.out_of_view, 0.04);
        EXPECT_NEAR(sum_of(r), 1, 1e-9);
        most.seen_free = std::max(most.seen_free, r.visibility->seen_free);
        most.unseen = std::max(most.unseen, r.visibility->unseen);
        most.out_of_view = std::max(most.out_of_view, r.visibility->out_of_view);
      }
    }
  }
  EXPECT_EQ(most.seen_free, 1);
  EXPECT_NEAR(most.unseen, 1, 1e-9);
  EXPECT_NEAR(most.out_of_view, 1, 1e-9);
}

// A tool that nothing hides, in the middle of the image, is seen free or inside to the last bit.
TEST(Visibility, LeavesNothingUnseenBeforeAWall) {
  const AnyBody wall(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kLatticeEdge, 10, 2);
  ToolQuery query(tool, {});
  for (double z = 0.6; z < 1; z += 0.013) {
    const Result r = query.run(wall, {generic_rotation(), {0.01, -0.02, z}});
    EXPECT_EQ(r.visibility->unseen, 0);
    EXPECT_EQ(r.visibility->out_of_view, 0);
    EXPECT_EQ(r.visibility->seen_free, 1 - r.volume_fraction);
  }
}

// Returns what the camera does not see of a tool of which all is free: part by part.
UnseenSum unseen_of(const ToolModel& tool, const DepthSurface& surface, const Pose& to_surface) {
  const Level& level = tool.level(0);
  const CellClusters cells = cluster_cells(tool, level);
  const std::vector<BlockMass> blocks = block_masses(level);
  UnseenSum sum;
  const auto add = [&](const BlockMass& part) {
    sum.add(part.weight, surface.sight_at(to_surface * part.centroid));
  };
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    if (is_compact(level.cell_radius[i], tool.radius)) {
      add(cells.masses[i]);
    } else {
      for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b)
        add(blocks[b]);
    }
  }
  return sum;
}

// Returns a noisy image with holes.
Cloud rough(const char* scene) {
  auto [camera, image] = testing::small_noisy_image(scene);
  for (std::size_t i = 0; i < image.depth.size(); ++i)
    if (i % 37 < 7 || i % 5 == 0) image.depth[i] = 0;
  return make_cloud(image, camera, {.window = 3});
}

TEST(Visibility, AddsUpToOneWithTheSameBitsForAnyThreads) {
  for (const char* scene : {"wall", "groove", "plate", "block", "step"}) {
    const AnyBody cloud(rough(scene));
    for (const ToolModel& tool : {lattice_cube(kLatticeEdge, 9, 2), lattice_cube(0.4, 20, 1)}) {
      QueryOptions solid;
      solid.shadows = Shadows::solid;
      ToolQuery near(tool, {}), all(tool, solid);
      for (int k = 0; k < 30; ++k) {
        SCOPED_TRACE(::testing::Message() << scene << ' ' << k);
        const Pose pose{generic_rotation(), {0.03 * k - 0.45, 0.02 * k - 0.3, 0.06 * k}};
        set_thread_count(1);
        const Result r = near.run(cloud, pose), s = all.run(cloud, pose);
        for (const Result& one : {r, s}) {
          EXPECT_NEAR(sum_of(one), 1, 1e-9);
          for (const double part :
               {one.visibility->seen_free, one.visibility->unseen, one.visibility->out_of_view})
            EXPECT_GE(part, 0);
        }
        // What is taken for solid was unseen.
        EXPECT_NEAR(r.visibility->out_of_view, s.visibility->out_of_view, 1e-12);
        EXPECT_GE(r.visibility->unseen + 1e-12, s.visibility->unseen);
        set_thread_count(3);
        testing::expect_equal(r, near.run(cloud, pose));
      }
    }
  }
  set_thread_count(0);
}

// Clusters, groups and larger parts that are told as one add the bits of their parts one by one.
TEST(Visibility, OfFreeToolsIsThatOfTheirParts) {
  const DepthBody clean(testing::wall_with_hole()), holey(rough("wall"));
  bool any_unseen = false, any_out_of_view = false;
  for (const DepthBody& body : {clean, holey}) {
    const DepthSurface surface = body.surface();
    for (const ToolModel& tool : {lattice_cube(0.1, 10, 2), lattice_cube(0.1, 5, 4)}) {
      RefinedMeasure measure(tool, tool.level(0), {});
      for (int k = 0; k < 200; ++k) {
        SCOPED_TRACE(k);
        const Pose pose{generic_rotation(),
                        {0.006 * k - 0.6, 0.3 - 0.003 * k, 0.3 + 0.006 * (k % 80)}};
        const BodySum found = measure.run(body, pose);
        ASSERT_EQ(found.sum.volume.value, 0);
        const Pose to_surface = pose_in_body(body.to_world(), pose, tool.center_of_mass);
        EXPECT_EQ(found.unseen, unseen_of(tool, surface, to_surface));
        any_unseen |= found.unseen->unseen.value > 0;
        any_out_of_view |= found.unseen->out_of_view.value > 0;
      }
    }
  }
  EXPECT_TRUE(any_unseen);
  EXPECT_TRUE(any_out_of_view);
}

TEST(Visibility, IsOfOneCamera) {
  const Cloud seen = testing::wall_with_hole();
  const AnyBody image(seen), points(without_camera(seen));
  const ToolModel tool = lattice_cube(kLatticeEdge, 6, 2);
  ToolQuery query(tool, {});
  const Pose pose{generic_rotation(), {0.3, 0, 1}};
  const Result alone = query.run(image, pose);
  ASSERT_TRUE(alone.visibility);
  EXPECT_FALSE(query.run(std::array{image, image}, pose).visibility);
  EXPECT_EQ(query.run(std::array{image, points}, pose).visibility, alone.visibility);
  EXPECT_EQ(query.run(std::array{points, image}, pose).visibility, alone.visibility);
  // Points say free where a camera that is there, too, does not look.
  const Pose behind{generic_rotation(), {0.3, 0, -1}};
  EXPECT_EQ(query.run(points, behind).visibility->seen_free, 1);
  for (const auto& bodies : {std::array{image, points}, std::array{points, image}})
    EXPECT_EQ(query.run(bodies, behind).visibility->out_of_view, 1);
  QueryOptions paper;
  paper.measure = Measure::paper;
  EXPECT_FALSE(ToolQuery(tool, paper).run(image, pose).visibility);
}

TEST(Collides, IsUnknownWhereTooMuchIsNotSeen) {
  Result result;
  EXPECT_EQ(collides(result), Collides::unknown);  // nobody has seen anything
  result.visibility = {.seen_free = 1};
  EXPECT_EQ(collides(result), Collides::no);
  result.visibility = {.seen_free = 0.97, .unseen = 0.015, .out_of_view = 0.015};
  EXPECT_EQ(collides(result), Collides::unknown);
  EXPECT_EQ(collides(result, 0.031), Collides::no);
  EXPECT_EQ(collides(result, 0), Collides::unknown);
  EXPECT_EQ(collides(result, std::nan("")), Collides::unknown);
  result.volume = 1e-12;
  for (const double limit : {0.0, 0.02, 1.0}) EXPECT_EQ(collides(result, limit), Collides::yes);
}

// Of a tool 30 cm behind a wall nobody can know if it collides, and the answer says so.
TEST(Collides, IsUnknownFarBehindAWall) {
  const AnyBody wall(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kLatticeEdge, 6, 2);
  ToolQuery query(tool, {});
  const auto at = [&](double z) { return collides(query.run(wall, {{}, {0, 0, z}})); };
  EXPECT_EQ(at(0.8), Collides::no);
  EXPECT_EQ(at(0.95), Collides::yes);
  for (const double z : {1.4, 1.6, 3.0}) EXPECT_EQ(at(z), Collides::unknown) << z;
}

// However early it ends, the answer is that of the whole query.
TEST(Collides, IsThatOfTheWholeQuery) {
  int found[3] = {};
  for (const char* scene : {"wall", "groove", "plate", "step"}) {
    const Cloud cloud = rough(scene);
    const AnyBody image(cloud), points(without_camera(cloud));
    const std::vector<std::vector<AnyBody>> scenes{{image}, {points}, {image, points}};
    for (const Shadows shadows : {Shadows::near, Shadows::solid}) {
      QueryOptions options;
      options.shadows = shadows;
      const ToolModel tool = lattice_cube(kLatticeEdge, 9, 2);
      ToolQuery whole(tool, options), early(tool, options);
      for (std::size_t s = 0; s < (shadows == Shadows::near ? scenes.size() : 1); ++s) {
        for (int k = 0; k < 30; ++k) {
          SCOPED_TRACE(::testing::Message() << scene << ' ' << s << ' ' << k);
          const Pose pose{generic_rotation(), {0.04 * k - 0.6, 0.02 * k - 0.3, 0.5 + 0.04 * k}};
          const double limit = 0.05 * (k % 5);
          const Collides expected = collides(whole.run(scenes[s], pose), limit);
          ASSERT_EQ(early.collides(scenes[s], pose, limit), expected);
          ++found[static_cast<int>(expected)];
          // What ended early leaves nothing behind.
          testing::expect_equal(early.run(scenes[s], pose), whole.run(scenes[s], pose));
        }
      }
    }
  }
  for (const int count : found) EXPECT_GT(count, 15);
}

TEST(Collides, RefusesALimitThatIsNoPart) {
  const AnyBody wall(testing::see(synthetic::make_scene("wall")));
  const ToolModel tool = lattice_cube(kLatticeEdge, 6, 2);
  ToolQuery query(tool, {});
  for (const double limit : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW(query.collides({&wall, 1}, {}, limit), Error) << limit;
}

}  // namespace
}  // namespace vpm
