#include "libvpm/graph/cell_pieces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <span>

#include "libvpm/backend/cell_clusters.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/measure/tool_piece.h"
#include "libvpm/synthetic/truth.h"
#include "tests/graph/test_packing.h"

namespace vpm {
namespace {

// Returns the volume fraction of the samples below a surface. `plane_at` returns the plane that
// stands for it at a place; places are relative to the centre of mass.
template <class PlaneAt>
double fraction_inside(const Level& level, const PlaneAt& plane_at) {
  const NumberedSamples numbered = numbered_samples(level);
  double sum = 0;
  for (const CellSample& s : numbered.samples) {
    const Vec3 x = widen(s.center);
    const TangentPlane plane = plane_at(x);
    sum +=
        s.weight * fraction_behind(shape_of(s, numbered.faces()), plane.distance(x), plane.normal);
  }
  return sum;
}
double fraction_below(const Level& level, Vec3 normal, double offset) {
  return fraction_inside(level, [&](Vec3) { return TangentPlane{normal, offset * normal}; });
}

struct Error {
  double mean = 0, worst = 0;
  int count = 0;
  void add(double error) {
    mean = (mean * count + std::abs(error)) / (count + 1);
    worst = std::max(worst, std::abs(error));
    ++count;
  }
};

class Cells : public testing::TestWithParam<test::Shape (*)()> {};

// Checks the promise of samples_per_length.
TEST_P(Cells, CutByPlanesAndBallsAsTheSolid) {
  const test::Shape shape = GetParam()();
  const Packing packing = test::greedy_packing(shape, 1000);
  const ToolModel model = build_tool_model(packing, {});
  const Level& level = model.levels.back();
  test::Numbers numbers(1);
  Error plane, ball;
  for (int k = 0; k < 200; ++k) {
    const Vec3 normal = numbers.direction();
    const double offset = numbers.uniform(-0.8, 0.8) * model.radius;
    const double truth =
        test::volume_below(packing.solid, normal, offset + dot(normal, model.center_of_mass)) /
        model.volume;
    plane.add(fraction_below(level, normal, offset) - truth);
  }
  const synthetic::TrueSolid solid(packing.solid);
  const double radius = 3 * model.radius;
  for (int k = 0; k < 10; ++k) {
    const Vec3 center = (radius + numbers.uniform(-0.6, 0.6) * model.radius) * numbers.direction();
    const auto truth =
        solid.penetration({}, *synthetic::make_ball(center + model.center_of_mass, radius), 1e-5);
    const auto tangent = [&](Vec3 x) {
      const Vec3 normal = normalized_or_zero(x - center);
      return TangentPlane{normal, center + radius * normal};
    };
    ball.add(fraction_inside(level, tangent) - truth.volume / model.volume);
  }
  EXPECT_LE(plane.mean, 1e-4);
  EXPECT_LE(plane.worst, 5e-4);
  EXPECT_LE(ball.worst, 5e-4);
  RecordProperty("samples", static_cast<int>(level.samples.size()));
  EXPECT_LE(level.samples.size(), 100000u);
}

// Cuts along a face, where the errors of neighbouring samples add up.
TEST_P(Cells, SmoothFacesByLittle) {
  const test::Shape shape = GetParam()();
  const Packing packing = test::greedy_packing(shape, 1000);
  const ToolModel model = build_tool_model(packing, {});
  const Triangle& t = packing.solid.triangles[0];
  const Vec3 a = packing.solid.vertices[t[0]];
  const Vec3 normal =
      normalized_or_zero(cross(packing.solid.vertices[t[1]] - a, packing.solid.vertices[t[2]] - a));
  double face = -HUGE_VAL;
  for (const Vec3& v : packing.solid.vertices) face = std::max(face, dot(normal, v));
  Error error;
  for (int k = 0; k < 100; ++k) {
    const double offset = face - dot(normal, model.center_of_mass) - 0.002 * k * model.radius;
    const double truth =
        test::volume_below(packing.solid, normal, offset + dot(normal, model.center_of_mass)) /
        model.volume;
    error.add(fraction_below(model.levels[0], normal, offset) - truth);
  }
  EXPECT_LE(error.worst, 1e-3);
}

// Returns how far the solid reaches along a direction from its centre of mass.
double support(const Packing& packing, const ToolModel& model, Vec3 direction) {
  double most = -HUGE_VAL;
  for (const Vec3& v : packing.solid.vertices)
    most = std::max(most, dot(direction, v - model.center_of_mass));
  return most;
}
Vec3 normal_of(const Solid& solid, const Triangle& t) {
  const Vec3 a = solid.vertices[t[0]];
  return normalized_or_zero(cross(solid.vertices[t[1]] - a, solid.vertices[t[2]] - a));
}

using FacesCase = std::tuple<test::Shape (*)(), std::size_t>;  // and spheres
class Faces : public testing::TestWithParam<FacesCase> {};

// Planes come from all sides, also flush with each face and a little turned from it, to a
// thousandth of the tool radius. Behind the planes of all faces, as in a scan of itself, a tool is
// whole.
TEST_P(Faces, CountForNothingBeforeContactAndWholeBehindThem) {
  const auto [shape_of_case, spheres] = GetParam();
  const test::Shape shape = shape_of_case();
  const Packing packing = test::greedy_packing(shape, spheres, 9261);
  const ToolModel model = build_tool_model(packing, {});
  test::Numbers numbers(5);
  const auto expect_nothing = [&](Vec3 direction) {
    const double before = -support(packing, model, direction) - 1e-3 * model.radius;
    EXPECT_LE(fraction_below(model.levels[0], -direction, before), 1e-6);
  };
  const std::vector<Triangle>& triangles = packing.solid.triangles;
  for (std::size_t k = 0; k < triangles.size(); k += 1 + k / 20) {
    const Vec3 face = normal_of(packing.solid, triangles[k]);
    expect_nothing(face);
    expect_nothing(normalized_or_zero(face + 0.03 * numbers.direction()));
  }
  for (int k = 0; k < 30; ++k) expect_nothing(numbers.direction());
  if (shape.name == "torus") return;  // is not behind the planes of its faces
  double lost = 0;
  for (const Triangle& t : triangles) {
    const Vec3 face = normal_of(packing.solid, t);
    lost += 1 - fraction_below(model.levels[0], face, support(packing, model, face));
  }
  EXPECT_LE(lost, shape.name == "ball" ? 1.5e-3 : 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Faces,
                         testing::Combine(testing::Values(test::cube, test::tetrahedron,
                                                          test::octahedron, test::torus,
                                                          test::plate, test::wedge, test::ball),
                                          testing::Values(20, 200)),
                         [](const auto& tested) {
                           return std::get<0>(tested.param)().name + "_" +
                                  std::to_string(std::get<1>(tested.param));
                         });

TEST_P(Cells, HoldTheVolumeOfTheirCell) {
  const Packing packing = test::greedy_packing(GetParam()(), 300, 40000);
  const ToolModel model = build_tool_model(packing, {});
  const Level& level = model.levels.back();
  double sum = 0;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    double weight = 0;
    Vec3 moment;
    for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b) {
      const CellBlock& block = level.blocks[b];
      ASSERT_LT(block.begin, block.end);
      ASSERT_LE(block.end - block.begin, 64u);
      for (std::uint32_t s = block.begin; s < block.end; ++s) {
        const CellSample& sample = level.samples[s];
        ASSERT_LE(norm(widen(sample.center) - widen(block.center)), double{block.radius});
        weight += sample.weight;
        moment += sample.weight * widen(sample.center);
      }
    }
    EXPECT_NEAR(weight * model.volume / level.cell_volume[i], 1, 1e-11);
    const Vec3 centroid = moment / weight + model.center_of_mass;
    EXPECT_LT(norm(centroid - level.cell_centroid[i]), 1e-6 * model.radius);
    sum += weight;
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

// Returns the sum of squared distances from their mean.
double scatter(std::span<const CellSample> samples) {
  Vec3 mean;
  for (const CellSample& s : samples) mean += widen(s.center) / static_cast<double>(samples.size());
  double sum = 0;
  for (const CellSample& s : samples) sum += squared_norm(widen(s.center) - mean);
  return sum;
}

// A body cut into n equal parts each way has parts that scatter by 1 / n^2 of it: blocks of 64
// samples in groups of 4 by (4 / 64)^(2/3) = 0.16, if both were cubes.
TEST_P(Cells, SamplesThatFollowOneAnotherLieSideBySide) {
  const ToolModel model = build_tool_model(test::greedy_packing(GetParam()(), 300, 40000), {});
  const Level& level = model.levels.back();
  const std::span<const CellSample> samples = level.samples;
  double of_neighbors = 0, of_blocks = 0;
  for (const CellBlock& block : level.blocks) {
    of_blocks += scatter(samples.subspan(block.begin, block.end - block.begin));
    for (std::uint32_t s = block.begin; s < block.end; s += kNeighborSamples)
      of_neighbors += scatter(samples.subspan(s, std::min(kNeighborSamples, block.end - s)));
  }
  EXPECT_LT(of_neighbors, 0.2 * of_blocks);
}

// Every point of the solid lies in a block of the sphere whose surface is nearest.
TEST_P(Cells, BlocksEncloseTheirCell) {
  const test::Shape shape = GetParam()();
  const Packing packing = test::greedy_packing(shape, 300, 40000);
  const ToolModel model = build_tool_model(packing, {});
  const Level& level = model.levels.back();
  const SphereBvh bvh(packing.spheres);
  test::Numbers numbers(3);
  int inside = 0, found = 0;
  for (int k = 0; k < 20000; ++k) {
    const Vec3 x =
        model.radius * Vec3{numbers.uniform(-1, 1), numbers.uniform(-1, 1), numbers.uniform(-1, 1)};
    if (!(shape.depth(x + model.center_of_mass) > 0)) continue;
    ++inside;
    const std::uint32_t i = bvh.nearest_surface(x + model.center_of_mass, 0);
    EXPECT_LE(norm(x + model.center_of_mass - packing.spheres[i].center),
              level.cell_radius[i] + 0.01 * model.radius);
    bool enclosed = false;
    for (std::uint32_t b = level.block_begin[i]; b < level.block_begin[i + 1]; ++b) {
      enclosed |= norm(x - widen(level.blocks[b].center)) <= double{level.blocks[b].radius};
    }
    found += enclosed;
  }
  // Cells are known to the spacing of lines: places between two lines may belong to a neighbour.
  EXPECT_GE(found, 0.999 * inside);
}

INSTANTIATE_TEST_SUITE_P(Shapes, Cells,
                         testing::Values(test::cube, test::tetrahedron, test::octahedron,
                                         test::torus),
                         [](const auto& tested) { return tested.param().name; });

// Beside the edge between two legs one face is seen along its plane, which is not from outside.
TEST(SolidFaces, MoveOnlyCentroidsThatLieOutside) {
  Solid angle;  // two legs of 2 x 1 m
  for (const double z : {0.0, 1.0})
    for (const Vec3 at :
         {Vec3{0, 0, z}, Vec3{2, 0, z}, Vec3{2, 1, z}, Vec3{1, 1, z}, Vec3{1, 2, z}, Vec3{0, 2, z}})
      angle.vertices.push_back(at);
  for (std::uint32_t k = 1; k < 5; ++k) {
    angle.triangles.push_back({0, k + 1, k});
    angle.triangles.push_back({6, k + 6, k + 7});
  }
  for (std::uint32_t k = 0; k < 6; ++k) {
    const std::uint32_t next = (k + 1) % 6;
    angle.triangles.push_back({k, next, next + 6});
    angle.triangles.push_back({k, next + 6, k + 6});
  }
  const SolidFaces faces(angle, 1.5);
  const double radius = 0.3;
  for (const double depth : {0.01, 0.1, 0.29}) {
    for (const Vec3 at : {Vec3{1, 1 - depth, 0.5}, Vec3{1 - depth, 1, 0.5}}) {
      Vec3 centroid = at;
      const auto face = faces.beside(centroid, radius, Moment::of_ball(radius));
      EXPECT_EQ(norm(centroid - at), 0);
      ASSERT_TRUE(face);
      EXPECT_NEAR(face->toward, depth, 1e-6);
    }
  }
  Vec3 outside{2.01, 0.5, 0.5};
  EXPECT_TRUE(faces.beside(outside, radius, Moment::of_ball(radius)));
  EXPECT_LT(outside.x, 2);
  EXPECT_GT(outside.x, 2 - 0.01 * radius);
}

TEST(BallPieces, SumToTheBall) {
  for (const double radius : {0.1, 1.0, 1.7, 2.5, 4.0, 9.3}) {
    std::vector<CellPiece> pieces;
    cut_ball(radius, 1, pieces);
    double sum = 0, second = 0;
    Vec3 moment;
    for (const CellPiece& p : pieces) {
      sum += p.volume;
      moment += p.volume * p.centroid;
      second += p.volume * (squared_norm(p.centroid) + 0.6 * p.moment_radius * p.moment_radius);
      EXPECT_LE(norm(p.centroid), radius);
      EXPECT_GE(p.bounding_radius, 0.999 * p.moment_radius);
    }
    const double exact = volume({{}, radius});
    EXPECT_NEAR(sum / exact, 1, 1e-13);
    EXPECT_LT(norm(moment) / exact, 1e-12 * radius);
    EXPECT_NEAR(second / (exact * 0.6 * radius * radius), 1,
                0.01);  // 3/5 r^2 is the mean squared radius
    if (radius > 2) {
      EXPECT_NEAR(static_cast<double>(pieces.size()) / exact, 1, 0.5);
    }
  }
}

}  // namespace
}  // namespace vpm
