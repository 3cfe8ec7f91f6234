// Surface samples by vectors have the bits of single samples.
#include <gtest/gtest.h>

#include <bit>
#include <limits>

#include "libvpm/backend/cpu/cell_samples.h"
#include "libvpm/cloud/normals.h"
#include "libvpm/measure/contact_patch.h"
#include "libvpm/scene/depth/depth_body.h"
#include "libvpm/synthetic/render.h"
#include "tests/query/lattice_model.h"
#include "tests/query/samples_beside_faces.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

using testing::Draws;
using testing::with_faces;

// Returns a cloud with creases, jumps, noise and holes.
Cloud rough_cloud(const char* scene) {
  auto [camera, image] = testing::small_noisy_image(scene);
  Draws numbers;
  for (float& depth : image.depth) {
    if (numbers.between(0, 1) < 0.02) depth = 0;
    if (numbers.between(0, 1) < 0.02) depth *= 1.05F;
  }
  return make_cloud(image, camera, {.window = 3});
}

// Returns a place near the surface, beside the image, behind the camera, or where nothing was
// measured.
Vec3 any_place(Draws& numbers) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  static const Vec3 odd[] = {{0, 0, 0},      {0.1, HUGE_VAL, 1}, {0, 0, 1e-40}, {0, 0, 0x1p-100},
                             {0, 0, 1e-300}, {kNaN, 0, 1},       {0, 0, kNaN},  {0, 0, HUGE_VAL}};
  const double kind = numbers.between(0, 1);
  if (kind < 0.03) return odd[static_cast<std::size_t>(numbers.between(0, std::size(odd)))];
  const double depth = kind < 0.1 ? numbers.between(-1, 1) : numbers.between(0.6, 1.6);
  return {depth * numbers.between(-0.7, 0.7), depth * numbers.between(-0.55, 0.55), depth};
}

std::uint64_t bits(double number) {
  return std::bit_cast<std::uint64_t>(number);
}
void expect_same(double a, double b) {
  EXPECT_TRUE(bits(a) == bits(b) || (std::isnan(a) && std::isnan(b))) << a << " and " << b;
}
void expect_same(Vec3 a, Vec3 b) {
  expect_same(a.x, b.x);
  expect_same(a.y, b.y);
  expect_same(a.z, b.z);
}
void expect_same(const SurfaceSample& a, const SurfaceSample& b) {
  EXPECT_EQ(a.known, b.known);
  expect_same(a.distance, b.distance);
  expect_same(a.normal, b.normal);
  expect_same(a.foot, b.foot);
  EXPECT_EQ(a.point, b.point);
}

int known_of_four(const DepthSurface& surface, Draws& numbers) {
  Vec3 places[4];
  SurfaceSample together[4];
  for (Vec3& place : places) place = any_place(numbers);
  sample_four(surface, places, together);
  int known = 0;
  for (int k = 0; k < 4; ++k) {
    const SurfaceSample one = surface.sample(places[k]);
    expect_same(together[k], one);
    known += one.known ? 1 : 0;
  }
  return known;
}

// Compares the normals of `count` places behind the surface.
void expect_same_normals(const DepthSurface& surface, std::size_t count, Draws& numbers,
                         int& turned) {
  std::vector<PlaceSample> places(count);
  for (PlaceSample& place : places) {
    do {
      place.x = any_place(numbers);
      place.on_surface = surface.sample(place.x);
    } while (!(place.on_surface.known && place.on_surface.distance < 0));
  }
  std::vector<Vec3> normals(count);
  closest_normals(surface, places, normals.data());
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3 one = surface.closest_normal(places[k].x, places[k].on_surface);
    expect_same(normals[k], one);
    turned += one != places[k].on_surface.normal ? 1 : 0;
  }
}

class DepthReadings : public ::testing::TestWithParam<const char*> {
 protected:
  // Removes some normals, and turns some so that they cannot be right.
  DepthReadings() {
    for (Vec3f& normal : normals_) {
      const double kind = draws_.between(0, 1);
      if (kind < 0.03) normal = kind < 0.01 ? Vec3f{} : Vec3f{1, 0, 0};
    }
    surface_.normals = normals_.data();
  }

  DepthBody cloud_{rough_cloud(GetParam())};
  DepthSurface surface_ = cloud_.surface();
  std::vector<Vec3f> normals_ = std::vector<Vec3f>(
      surface_.normals, surface_.normals + std::ptrdiff_t{surface_.width} * surface_.height);
  Draws draws_;
};

TEST_P(DepthReadings, OfFourPlacesAreThoseOfEach) {
  int known = 0;
  for (int k = 0; k < 20000; ++k) known += known_of_four(surface_, draws_);
  EXPECT_GT(known, 5000);
}

TEST_P(DepthReadings, OfSamplesAreThoseOfEachThatTheSurfaceMayReach) {
  int reached = 0, of_no_size = 0;
  for (int k = 0; k < 2000; ++k) {
    const Pose to_surface{testing::generic_rotation(), any_place(draws_)};
    Level level;
    level.samples.resize(static_cast<std::size_t>(draws_.between(0, 40)));
    for (CellSample& sample : level.samples) {
      const double radius = std::max(0.0, draws_.between(-0.005, 0.02));
      sample = {narrow(draws_.place(0.05)), static_cast<float>(radius), 1};
    }
    const auto& [samples, rows] = with_faces(draws_, level);
    const SampleFaces faces{rows.data()};
    std::vector<SurfaceOfSample> together(samples.size());
    together.resize(
        sample_surface(surface_, to_surface, samples, faces, HUGE_VAL, together.data()));
    std::size_t found = 0;
    for (std::uint32_t s = 0; s < samples.size(); ++s) {
      const Vec3 x = to_surface * widen(samples[s].center);
      const SurfaceSample on_surface = surface_.sample(x);
      const TurnedShape shape{shape_of(samples[s], faces), to_surface.rotation};
      if (on_surface.known && !(on_surface.distance < shape.reach_toward(on_surface.normal)))
        continue;
      ASSERT_LT(found, together.size());
      EXPECT_EQ(together[found].sample, s);
      expect_same(together[found].at.x, x);
      expect_same(together[found].at.on_surface, on_surface);
      ++found;
      of_no_size += samples[s].radius == 0 ? 1 : 0;
    }
    EXPECT_EQ(found, together.size());
    reached += static_cast<int>(found);
  }
  EXPECT_GT(reached, 1000);
  EXPECT_GT(of_no_size, 100);
}

TEST_P(DepthReadings, FindTheNormalsThatEachFinds) {
  int turned = 0;
  for (std::size_t k = 0; k < 5000; ++k) expect_same_normals(surface_, k % 10, draws_, turned);
  EXPECT_GT(turned, 3000);
}

void expect_same(const CellResult& a, const CellResult& b) {
  EXPECT_EQ(a.sum.volume.value, b.sum.volume.value);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(a.sum.force[axis].value, b.sum.force[axis].value);
    EXPECT_EQ(a.sum.torque[axis].value, b.sum.torque[axis].value);
    EXPECT_EQ(a.plane.normal[axis].value, b.plane.normal[axis].value);
    EXPECT_EQ(a.plane.foot[axis].value, b.plane.foot[axis].value);
  }
  EXPECT_EQ(a.plane.count, b.plane.count);
  EXPECT_EQ(a.is_far, b.is_far);
  EXPECT_EQ(a.far_count, b.far_count);
  EXPECT_EQ(a.unseen, b.unseen);
}

// Expects the same lists of far pieces, and the same sum of those on one side of the tool, taken
// one after the other and together.
void expect_same_far_pieces(const CellMeasure<DepthSurface>& measure,
                            std::span<const PieceIndex> in_turn,
                            std::span<const PieceIndex> together) {
  ASSERT_EQ(in_turn.size(), together.size());
  for (std::size_t k = 0; k < in_turn.size(); ++k) EXPECT_EQ(in_turn[k].bits, together[k].bits);
  const auto supports = [&](Vec3 x, Vec3 foot) {
    return x.x > measure.to_surface().translation.x && foot.z > 0;
  };
  ToolSum sum, of_together;
  UnseenSum unseen, unseen_together;
  measure.add_far(in_turn, supports, sum, unseen);
  SamplesTogether::add_far(measure, together, supports, of_together, unseen_together);
  EXPECT_EQ(sum, of_together);
  EXPECT_EQ(unseen, unseen_together);
}

TEST_P(DepthReadings, AddToACellWhatOneAfterTheOtherDoes) {
  const ToolModel tool = testing::lattice_cube(0.2, 4, 5);
  const Level& level = tool.levels[0];
  const std::vector<BlockMass> masses = block_masses(level);
  const NumberedSamples numbered = numbered_samples(level);
  std::vector<PieceIndex> far_pieces(level.samples.size() + level.blocks.size()),
      of_together = far_pieces;
  int cut = 0, pushed = 0, far = 0;  // samples of blocks that are neither flat nor on one side
  for (int k = 0; k < 300; ++k) {
    const Pose to_surface{testing::generic_rotation(),
                          {draws_.between(-0.3, 0.3), 0, draws_.between(0.8, 1.2)}};
    // Takes the cells of two blocks.
    for (std::uint32_t i = 0; i + 1 < level.sphere_count; ++i) {
      const CellMeasure measure(
          surface_, to_surface, ToolRadius{tool.radius, Shadows::near},
          CellView{level.blocks.data(), masses.data(), numbered.samples.data(),
                   level.block_begin[i], level.block_begin[i + 2], tool.spheres[i].center,
                   2 * level.cell_radius[i], numbered.faces()});
      const CellResult result = measure.run(SamplesInTurn{}, far_pieces.data());
      expect_same(result, measure.run(SamplesTogether{}, of_together.data()));
      expect_same_far_pieces(measure, {far_pieces.data(), result.far_count},
                             {of_together.data(), result.far_count});
      const CellBlock& block = level.blocks[level.block_begin[i]];
      const auto in_block = measure.classify_block(block);
      if (in_block.found != BlockClass::ambiguous) continue;
      for (std::uint32_t s = block.begin; s < block.end; ++s) {
        const auto in_ball = measure.sample_piece(measure.piece_of_sample(s));
        if (!in_ball.is_inside) continue;
        ++(in_ball.is_far ? far : in_ball.side == PlaneSide::cut ? cut : pushed);
      }
    }
  }
  EXPECT_GT(cut, 500);
  EXPECT_GT(pushed, 500);
  if (std::string(GetParam()) == "block") {
    EXPECT_GT(far, 500);
  }
}

Vec3 force_of(const ToolSum& sum) {
  return {sum.force[0].real(), sum.force[1].real(), sum.force[2].real()};
}

TEST_P(DepthReadings, PushNeighborsTogetherWhereEachGoesAlone) {
  const ToolModel tool = testing::lattice_cube(0.2, 4, 4);
  const Level& level = tool.levels[0];
  const std::vector<BlockMass> masses = block_masses(level);
  const NumberedSamples numbered = numbered_samples(level);
  std::vector<PieceIndex> far(level.samples.size() + level.blocks.size());
  double volume = 0;
  Vec3 together, alone;
  for (int k = 0; k < 300; ++k) {
    const Pose to_surface{testing::generic_rotation(),
                          {draws_.between(-0.3, 0.3), 0, draws_.between(0.8, 1.2)}};
    for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
      const CellMeasure measure(
          surface_, to_surface, ToolRadius{tool.radius, Shadows::near},
          CellView{level.blocks.data(), masses.data(), numbered.samples.data(),
                   level.block_begin[i], level.block_begin[i + 1], tool.spheres[i].center,
                   level.cell_radius[i], numbered.faces()});
      const CellBlock& block = level.blocks[level.block_begin[i]];
      const auto in_block = measure.classify_block(block);
      if (in_block.found != BlockClass::ambiguous) continue;
      CellResult of_each;
      bool any_far = false;
      for (std::uint32_t s = block.begin; s < block.end; ++s) {
        const ToolPiece piece = measure.piece_of_sample(s);
        const auto in_ball = measure.sample_piece(piece);
        any_far |= in_ball.is_inside && in_ball.is_far;
        if (!in_ball.is_inside) continue;
        const WayOut way = measure.way_out(in_ball, false);
        measure.push(piece, in_ball, measure.own_normal(way, in_ball), measure.surface(),
                     of_each.sum);
      }
      if (any_far) continue;
      const CellResult result = measure.run(SamplesTogether{}, far.data());
      ASSERT_EQ(result.sum.volume.value, of_each.sum.volume.value);
      volume += result.sum.volume.real();
      together += force_of(result.sum);
      alone += force_of(of_each.sum);
    }
  }
  EXPECT_LT(norm(together - alone), 0.01 * volume);
}

INSTANTIATE_TEST_SUITE_P(Scenes, DepthReadings,
                         ::testing::Values("tilted-wall", "ball", "groove", "step", "plate",
                                           "block"),
                         [](const auto& variant) { return test::test_name(variant.param); });

// An image that shows a rough wall at about 1 m.
struct SmallImage {
  SmallImage(std::int32_t width, std::int32_t height) {
    Draws numbers;
    for (std::int32_t k = 0; k < width * height; ++k) {
      const auto inverse_depth = static_cast<float>(numbers.between(0.98, 1.02));
      pixels.push_back({inverse_depth, inverse_depth});
      normals.push_back(narrow(normalized_or_zero(numbers.place(0.6) - Vec3{0, 0, 1})));
    }
    surface.k = {8, 8, (width - 1) / 2.0, (height - 1) / 2.0};
    surface.width = width;
    surface.height = height;
    surface.levels = 1;
    surface.tiles[0] = pixels.data();
    surface.normals = normals.data();
  }

  std::vector<InverseDepthRange> pixels;
  std::vector<Vec3f> normals;
  DepthSurface surface;
};

TEST(SmallImages, AreReadTogetherAsInTurn) {
  for (const std::int32_t width : {1, 2, 8, 9, 10}) {
    for (const std::int32_t height : {1, 8, 9}) {
      const SmallImage image(width, height);
      Draws numbers;
      int known = 0, turned = 0;
      for (std::size_t k = 0; k < 2000; ++k) {
        known += known_of_four(image.surface, numbers);
        expect_same_normals(image.surface, k % 5, numbers, turned);
      }
      EXPECT_GT(known, 100) << width << " x " << height;
    }
  }
}

// At the rim, 0.5 less than an ulp plus another 0.5 rounds to 1, which is no pixel.
TEST(SmallImages, HaveNoPixelBeyondTheirRim) {
  const SmallImage image(1, 1);
  const double rim = 0.5 - 0x1p-54;
  for (const Vec3 x : {Vec3{rim / 8, 0, 1}, Vec3{0, rim / 8, 1}}) {
    const SurfaceSample on_surface = image.surface.sample(x);
    EXPECT_TRUE(!on_surface.known || on_surface.point == 0) << on_surface.point;
    SurfaceSample together[4];
    sample_four(image.surface, {x, x, x, x}, together);
    for (const SurfaceSample& one : together) expect_same(one, on_surface);
  }
}

TEST(ClippedSamples, AddUpTogetherAsInTurn) {
  Draws numbers;
  int cut = 0, whole = 0, touched = 0;
  for (int k = 0; k < 20000; ++k) {
    ClipPlane plane;
    plane.normal = normalized_or_zero(numbers.place(1));
    plane.height = numbers.between(-0.12, 0.12);
    Level level;
    level.samples.resize(static_cast<std::size_t>(numbers.between(0, 40)));
    for (CellSample& sample : level.samples) {
      const double radius = std::max(0.0, numbers.between(-0.01, 0.03));
      sample = {narrow(numbers.place(0.1)), static_cast<float>(radius), numbers.between(0, 1)};
    }
    if (k % 4 == 0 && !level.samples.empty()) {  // through a centre, or touching, exactly
      const CellSample& sample = level.samples.front();
      plane.normal = {1, 0, 0};
      const int side = k % 12 / 4 - 1;
      plane.height = side * double{sample.radius} - double{sample.center.x};
      touched += std::abs(plane.distance(widen(sample.center))) == sample.radius ? 1 : 0;
    }
    const auto& [samples, rows] = with_faces(numbers, level);
    const SampleFaces faces{rows.data()};
    const auto count = static_cast<std::uint32_t>(samples.size());
    const ClippedMoments together = clipped_moments(plane, samples.data(), count, faces),
                         in_turn = SamplesInTurn::clipped(plane, samples.data(), count, faces);
    expect_same(together.weight, in_turn.weight);
    expect_same(together.moment, in_turn.moment);
    EXPECT_EQ(together.is_cut, in_turn.is_cut);
    double weight = 0;
    Vec3 moment;
    bool is_cut = false;
    for (const CellSample& sample : samples) {
      bool cuts = false;
      const double inside =
          weight_behind(shape_of(sample, faces), plane.normal, plane.distance(widen(sample.center)),
                        double{sample.weight}, cuts);
      is_cut |= cuts;
      weight += inside;
      moment += inside * widen(sample.center);
    }
    EXPECT_NEAR(in_turn.weight, weight, 1e-13);
    EXPECT_LE(norm(in_turn.moment - moment), 1e-14);
    EXPECT_EQ(in_turn.is_cut, is_cut);
    cut += in_turn.is_cut ? 1 : 0;
    whole += !in_turn.is_cut && in_turn.weight > 0 ? 1 : 0;
  }
  EXPECT_GT(cut, 5000);
  EXPECT_GT(whole, 100);
  EXPECT_GT(touched, 500);
}

TEST(SectionOfSamples, IsThatOfEachAlone) {
  Draws numbers;
  int behind_of_some = 0, cut = 0;
  for (int k = 0; k < 5000; ++k) {
    ClipPlane plane;
    plane.normal = normalized_or_zero(numbers.place(1));
    plane.height = numbers.between(-0.12, 0.12);
    Level level;
    level.samples.resize(static_cast<std::size_t>(numbers.between(0, kAtOnce + 1)));
    for (CellSample& sample : level.samples) {
      sample = {narrow(numbers.place(0.1)), static_cast<float>(numbers.between(0.001, 0.03)),
                numbers.between(0.1, 1)};
    }
    const auto& [samples, rows] = with_faces(numbers, level);
    const SampleFaces faces{rows.data()};
    CellSection together, of_each;
    const std::uint32_t behind = add_section(plane, samples, faces, together);
    std::uint32_t behind_of_each = 0;
    for (std::size_t s = 0; s < samples.size(); ++s) {
      const bool is_behind = of_each.add(shape_of(samples[s], faces), widen(samples[s].center),
                                         samples[s].weight, plane);
      behind_of_each |= (is_behind ? 1U : 0U) << s;
    }
    EXPECT_EQ(behind, behind_of_each);
    EXPECT_NEAR(together.weight, of_each.weight, 1e-13);
    EXPECT_LE(norm(together.moment - of_each.moment), 1e-14);
    EXPECT_NEAR(together.below, of_each.below, 1e-14);
    EXPECT_NEAR(together.section, of_each.section, 1e-12 * (1 + of_each.section));
    behind_of_some += behind != 0 && std::has_single_bit(behind + 1) ? 0 : 1;
    cut += of_each.section > 0 ? 1 : 0;
  }
  EXPECT_GT(behind_of_some, 1000);
  EXPECT_GT(cut, 1000);
}

}  // namespace
}  // namespace vpm
