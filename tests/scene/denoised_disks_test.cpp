// Tests points without a camera after denoising, at edges and thin plates.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "libvpm/core/parallel.h"
#include "libvpm/scene/points/disk_surface.h"
#include "libvpm/scene/points/prepared_points.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kSpacing = 0.002;  // m

class Noise {
 public:
  explicit Noise(unsigned seed = 1) : random_(seed) {}
  double next(double deviation) { return deviation * normal_(random_); }
  double within(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>()(random_);
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
};

void add_point(Vec3 place, Vec3 normal, Cloud& cloud) {
  cloud.positions.push_back(narrow(place));
  cloud.normals.push_back(narrow(normalized_or_zero(normal)));
  cloud.radii.push_back(static_cast<float>(kSpacing / std::sqrt(2.0)));
}
using Point = std::function<void(double x, double y, Cloud&)>;
// Adds points of a lattice over a square of 12 cm.
Cloud over_square(const Point& add) {
  constexpr int kHalf = 30;
  Cloud cloud;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int k = -kHalf; k <= kHalf; ++k) add(kSpacing * i, kSpacing * k, cloud);
  }
  return cloud;
}
bool is_inner(Vec3 p) {
  return std::fabs(p.x) < 0.04 && std::fabs(p.y) < 0.04;
}

// Returns a wall z = 0 with noise along z and in the normals' slopes.
Cloud noisy_wall(double height, double slope) {
  return over_square([=, noise = Noise()](double x, double y, Cloud& cloud) mutable {
    const double z = noise.next(height), a = noise.next(slope), b = noise.next(slope);
    add_point({x, y, z}, {a, b, 1}, cloud);
  });
}

// A roof over y (edge at x = z = 0), or the groove that it leaves, with normals estimated across
// windows of seven pixels.
struct Roof {
  bool is_convex;

  Vec3 normal_at(double x) const { return {is_convex == (x > 0) ? 1.0 : -1.0, 0, 1}; }
  double height(double x) const { return is_convex ? -std::fabs(x) : std::fabs(x); }
  double distance(Vec3 p) const {  // exact except for places beyond the edge
    const double left = (is_convex ? p.x : -p.x) + p.z, right = (is_convex ? -p.x : p.x) + p.z;
    return std::sqrt(0.5) * (is_convex ? std::max(left, right) : std::min(left, right));
  }
  Cloud seen(double deviation) const {
    return over_square(
        [this, deviation, noise = Noise()](double x, double y, Cloud& cloud) mutable {
          x += 0.3 * kSpacing;
          constexpr double kWindow = 3.5 * kSpacing;
          const double right = std::clamp(0.5 + x / (2 * kWindow), 0.0, 1.0);
          add_point({x, y, height(x) + noise.next(deviation)},
                    right * normal_at(1) + (1 - right) * normal_at(-1), cloud);
        });
  }
};

// Returns two sheets at z = +-half that face away from each other, with noise along z.
Cloud plate(double half, double deviation) {
  return over_square([=, noise = Noise()](double x, double y, Cloud& cloud) mutable {
    add_point({x, y, half + noise.next(deviation)}, {0, 0, 1}, cloud);
    add_point({x + 0.4 * kSpacing, y, -half + noise.next(deviation)}, {0, 0, -1}, cloud);
  });
}

// Returns the fraction of places classified on the wrong side, of those near the obstacle but
// further than `clear` from its surface.
double part_wrong(const PreparedPoints& cloud, double clear,
                  const std::function<double(Vec3)>& distance) {
  constexpr int kPlaces = 20000;
  Noise noise;
  int wrong = 0, asked = 0;
  const DiskSurface disks = cloud.surface();
  for (int k = 0; k < kPlaces; ++k) {
    const Vec3 x{noise.within(-0.04, 0.04), noise.within(-0.04, 0.04), noise.within(-0.03, 0.03)};
    const double d = distance(x);
    if (std::fabs(d) < clear) continue;
    ++asked;
    wrong += (disks.sample(x).distance < 0) != (d < 0);
  }
  EXPECT_GT(asked, kPlaces / 2);
  return static_cast<double>(wrong) / asked;
}

TEST(DenoisedDisks, NoiseIsAveraged) {
  constexpr double kHeight = 0.002, kSlope = 0.15;
  const PreparedPoints cloud(noisy_wall(kHeight, kSlope));
  double squared_height = 0, squared_slope = 0;
  int inner = 0;
  for (std::size_t i = 0; i < cloud.positions().size(); ++i) {
    const Vec3 foot = widen(cloud.disks().feet[i]), normal = widen(cloud.disks().normals[i]);
    if (!is_inner(foot)) continue;
    ++inner;
    squared_height += foot.z * foot.z;
    squared_slope += normal.x * normal.x + normal.y * normal.y;
  }
  EXPECT_GT(inner, 1500);
  EXPECT_LT(std::sqrt(squared_height / inner), kHeight / 3);
  EXPECT_LT(std::sqrt(squared_slope / 2 / inner), kSlope / 4);
}

TEST(DenoisedDisks, CurvatureMovesNothing) {
  constexpr double kRadius = 0.1;
  for (const double side : {1.0, -1.0}) {  // a ball, and the inside of one
    const PreparedPoints cloud(over_square([&](double x, double y, Cloud& points) {
      const double z = std::sqrt(kRadius * kRadius - x * x - y * y);
      add_point({x, y, side * z}, {x, y, side * z}, points);
    }));
    for (std::size_t i = 0; i < cloud.positions().size(); ++i) {
      const Vec3 foot = widen(cloud.disks().feet[i]);
      if (is_inner(foot)) {
        // A mean of heights would be off by a quarter of a millimetre.
        EXPECT_NEAR(norm(foot), kRadius, 1e-5);
        EXPECT_NEAR(norm(cross(widen(cloud.disks().normals[i]), 1 / kRadius * foot)), 0, 0.012);
      }
    }
    EXPECT_TRUE(cloud.disks().seconds.empty());
  }
}

TEST(DenoisedDisks, EdgesAndGroovesAreSharp) {
  for (const bool is_convex : {true, false}) {
    const Roof roof{is_convex};
    const auto distance = [&](Vec3 x) { return roof.distance(x); };
    const PreparedPoints clean(roof.seen(0));
    EXPECT_EQ(part_wrong(clean, 0.0004, distance), 0);
    for (std::size_t i = 0; i < clean.positions().size(); ++i) {
      const Vec3 foot = widen(clean.disks().feet[i]);
      if (is_inner(foot)) {
        EXPECT_NEAR(roof.distance(foot), 0, 0.0004);
      }
    }
    EXPECT_FALSE(clean.disks().seconds.empty());
    for (const SecondPlane& second : clean.disks().seconds) EXPECT_EQ(second.is_convex, is_convex);

    const Cloud noisy = roof.seen(0.001);
    EXPECT_LT(part_wrong(PreparedPoints(noisy), 0.0005, distance), 0.001);
    EXPECT_GT(part_wrong(PreparedPoints(noisy, Denoising::off), 0.0005, distance), 0.004);
  }
}

// The windows for normals reach across an edge; denoised normals do not mix its sides.
TEST(DenoisedDisks, NormalsBesideAnEdgeAreThoseOfTheirSide) {
  for (const bool is_convex : {true, false}) {
    const Roof roof{is_convex};
    const PreparedPoints cloud(roof.seen(0));
    int inner = 0;
    for (std::size_t i = 0; i < cloud.positions().size(); ++i) {
      const Vec3 foot = widen(cloud.disks().feet[i]), normal = widen(cloud.disks().normals[i]);
      if (!is_inner(foot) || std::fabs(foot.x) < kSpacing) continue;
      ++inner;
      const Vec3 side = normalized_or_zero(roof.normal_at(foot.x));
      EXPECT_NEAR(norm(normal - side), 0, 0.01) << foot.x;
    }
    EXPECT_GT(inner, 1000);
  }
}

// The riser of a step is little wider than two windows of normals, which lean towards top and floor
// at its ends. Disks that noise has turned that way have fewer unlike neighbours. If that made them
// count as further from the ends, the riser's mean would lean too.
TEST(DenoisedDisks, ANarrowWallDoesNotLean) {
  constexpr double kWide = 17 * kSpacing, kWindow = 3.5 * kSpacing;
  constexpr double kHeight = 0.0007, kTilt = 0.05;
  double lean = 0;
  int inner = 0;
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Noise noise(seed);
    // Returns the length of the profile from the riser's foot; the riser rises in x from -kWide to
    // 0.
    const auto part_of_riser = [&](double along) {
      const double on = std::min(along + kWindow, kWide) - std::max(along - kWindow, 0.0);
      return std::clamp(on / (2 * kWindow), 0.0, 1.0);
    };
    Cloud seen;
    for (double along = -20.2 * kSpacing; along < kWide + 20 * kSpacing; along += kSpacing) {
      const double up = std::clamp(along, 0.0, kWide), across = along - up;
      const bool is_riser = across == 0;
      for (int k = -30; k <= 30; ++k) {
        const Vec3 face = is_riser ? Vec3{-1, 0, 0} : Vec3{0, 0, 1};
        const double part = part_of_riser(along);
        const Vec3 tilt{noise.next(kTilt), noise.next(kTilt), noise.next(kTilt)};
        add_point(Vec3{across, kSpacing * k, up} + noise.next(kHeight) * face,
                  normalized_or_zero({-part, 0, 1 - part}) + tilt, seen);
      }
    }
    const PreparedPoints cloud(seen);
    for (std::size_t i = 0; i < cloud.positions().size(); ++i) {
      const Vec3 foot = widen(cloud.disks().feet[i]), normal = widen(cloud.disks().normals[i]);
      if (std::fabs(foot.z - kWide / 2) > 0.3 * kWide || std::fabs(foot.y) > 0.04) continue;
      if (std::fabs(foot.x) > kSpacing) continue;
      ++inner;
      lean += normal.z;
    }
  }
  EXPECT_GT(inner, 1500);
  EXPECT_NEAR(lean / inner, 0, 0.006);
}

// Noise is as large as the plate is thick, so points of its front lie behind its back.
TEST(DenoisedDisks, ThinPlatesKeepTheirSides) {
  constexpr double kHalf = 0.002;
  const auto distance = [](Vec3 x) { return std::fabs(x.z) - kHalf; };
  const Cloud noisy = plate(kHalf, 0.002);
  EXPECT_LT(part_wrong(PreparedPoints(noisy), 0.001, distance), 1e-3);
  EXPECT_GT(part_wrong(PreparedPoints(noisy, Denoising::off), 0.001, distance), 0.01);
}

// Opposite sides are recognised after denoising, so that points moved beyond the other side do not
// turn the plate into a slot.
TEST(DenoisedDisks, SheetsWithoutThicknessHoldNothing) {
  for (const double offset : {0.0, 0.4 * kSpacing}) {  // offset of one side's lattice
    const PreparedPoints cloud(over_square([&](double x, double y, Cloud& sheet) {
      add_point({x, y, 0}, {0, 0, 1}, sheet);
      add_point({x + offset, y - offset, 0}, {0, 0, -1}, sheet);
    }));
    const DiskSurface disks = cloud.surface();
    for (const double z : {-0.01, -0.001, 0.0, 0.001, 0.01}) {
      const Vec3 x{0.003, -0.007, z};
      const SurfaceSample on_surface = disks.sample(x);
      EXPECT_LT(disks.fraction_inside(on_surface, x, BallShape<double>{0.002}), 1e-6)
          << offset << ' ' << z;
    }
  }
}

TEST(DenoisedDisks, ThinPlatesAreNoSlots) {
  constexpr double kHalf = 0.002;
  const PreparedPoints cloud(plate(kHalf, 0.002));
  EXPECT_GT(cloud.disks().seconds.size(), 0.9 * static_cast<double>(cloud.positions().size()));
  double squared = 0;
  for (const SecondPlane& second : cloud.disks().seconds) {
    EXPECT_TRUE(second.is_convex);
    const double height = second.foot.z * (second.normal.z > 0 ? 1 : -1);
    squared += (height - kHalf) * (height - kHalf);
  }
  EXPECT_LT(std::sqrt(squared / static_cast<double>(cloud.disks().seconds.size())), 0.15 * kHalf);
}

TEST(DenoisedDisks, ABallInAPlateIsCutByBothSides) {
  constexpr double kHalf = 0.002, kRadius = 0.003;
  for (const double side : {1.0, -1.0}) {  // a plate, and a slot
    Cloud seen = plate(kHalf, 0);
    for (Vec3f& n : seen.normals) n.z *= static_cast<float>(side);
    const PreparedPoints cloud(seen);
    const DiskSurface disks = cloud.surface();
    const BallShape<double> ball{kRadius};
    const auto below = [&](double height) { return fraction_behind(ball, height, Vec3{}); };
    for (const double z : {-0.004, -0.002, -0.0003, 0.0, 0.001, 0.0025}) {
      const Vec3 x{0.0011, -0.0023, z};
      const double between = below(z - kHalf) - below(z + kHalf);
      EXPECT_NEAR(disks.fraction_inside(disks.sample(x), x, ball), side > 0 ? between : 1 - between,
                  1e-6);
    }
  }
}

// A ridge of a few points' width, which no smooth disk shows, is not taken for a part of the wall
// below it.
TEST(DenoisedDisks, SmallFeaturesStay) {
  for (const double radius : {0.004, 0.006, 0.009}) {
    const Cloud seen = over_square([&](double x, double y, Cloud& cloud) {
      x += 0.3 * kSpacing;
      const double squared = radius * radius - x * x;
      const double z = std::sqrt(std::max(squared, 0.0));
      add_point({x, y, z}, squared > 0 ? Vec3{x, 0, z} : Vec3{0, 0, 1}, cloud);
    });
    const auto distance = [&](Vec3 x) { return std::min(x.z, std::hypot(x.x, x.z) - radius); };
    const double measured = part_wrong(PreparedPoints(seen, Denoising::off), 0.0005, distance);
    EXPECT_LT(part_wrong(PreparedPoints(seen), 0.0005, distance), measured + 0.0015) << radius;
  }
}

// A place beyond an outlier's plane is not behind the surface.
TEST(DenoisedDisks, OutliersJoinTheirSurface) {
  Cloud seen = plate(0.002, 0.0003);
  add_point({0.0102, 0.0107, 0.008}, {0, 0, -1}, seen);  // from the back, in front of the front
  add_point({-0.0201, -0.0052, 0.010}, {-0.5, 0.2, 0.8}, seen);  // on no surface
  const auto distance = [](Vec3 x) { return std::fabs(x.z) - 0.002; };
  EXPECT_EQ(part_wrong(PreparedPoints(seen), 0.001, distance), 0);
  EXPECT_GT(part_wrong(PreparedPoints(seen, Denoising::off), 0.001, distance), 0.001);
}

// These outliers are far in front of a step's edge. They may fit the plane of the riser best, but
// there they would make a wall in free space.
TEST(DenoisedDisks, OutliersContinueNoWall) {
  Cloud seen = over_square([](double x, double y, Cloud& cloud) {
    add_point({x, y, x > 0 ? -0.04 : 0.0}, {0, 0, 1}, cloud);
  });
  for (int k = -30; k <= 30; ++k) {
    for (double z = -0.039; z < 0; z += kSpacing)
      add_point({0.001, kSpacing * k, z}, {1, 0, 0}, seen);
  }
  add_point({0.0004, 0.0103, 0.018}, {0.1, 0, 1}, seen);
  add_point({0.0012, -0.0207, 0.017}, {-0.3, 0.2, 0.9}, seen);
  const auto distance = [](Vec3 x) { return std::max(x.x - 0.001, x.z); };
  EXPECT_LT(part_wrong(PreparedPoints(seen), 0.002, distance), 1e-4);
  EXPECT_GT(part_wrong(PreparedPoints(seen, Denoising::off), 0.002, distance), 0.003);
}

void expect_same(const DenoisedDisks& a, const DenoisedDisks& b, float scale = 1) {
  const auto scaled = [&](Vec3f v) { return Vec3f{scale * v.x, scale * v.y, scale * v.z}; };
  ASSERT_EQ(a.feet.size(), b.feet.size());
  for (std::size_t i = 0; i < a.feet.size(); ++i) ASSERT_EQ(scaled(a.feet[i]), b.feet[i]);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.second_of, b.second_of);
  ASSERT_EQ(a.seconds.size(), b.seconds.size());
  for (std::size_t k = 0; k < a.seconds.size(); ++k) {
    ASSERT_EQ(a.seconds[k].normal, b.seconds[k].normal);
    ASSERT_EQ(scaled(a.seconds[k].foot), b.seconds[k].foot);
    ASSERT_EQ(a.seconds[k].is_convex, b.seconds[k].is_convex);
  }
}

// One to three points lie together far in front of a wall, with nothing else near.
TEST(DenoisedDisks, StraysJoinTheNearestDisk) {
  for (const int strays : {1, 2, 3}) {
    for (const double height : {0.007, 0.014, 0.021, 0.03}) {
      Cloud cloud = noisy_wall(0.0002, 0.02);
      for (int k = 0; k < strays; ++k)
        add_point({0.0003 * k, 0.0004, height}, {0.1 * k, 0.2, 1}, cloud);
      const PreparedPoints prepared(cloud);
      for (std::size_t i = 0; i < prepared.positions().size(); ++i) {
        EXPECT_LT(std::fabs(widen(prepared.disks().feet[i]).z), 0.001)
            << strays << " at " << height << " m";
        if (prepared.positions()[i].z > 0.005F) {
          const Vec3 aside = widen(prepared.disks().feet[i]) - widen(prepared.positions()[i]);
          EXPECT_LT(std::hypot(aside.x, aside.y), kSpacing);
        }
      }
    }
  }
}

// A disk wider than its spacing has more neighbours than are searched.
TEST(DenoisedDisks, StraysOfDenseCloudsJoinTheNearestDisk) {
  Cloud cloud = noisy_wall(0, 0);
  std::fill(cloud.radii.begin(), cloud.radii.end(), static_cast<float>(5 * kSpacing));
  add_point({0.0111, -0.0123, 0.1}, {0, 0.1, 1}, cloud);
  cloud.radii.back() = static_cast<float>(5 * kSpacing);
  const PreparedPoints prepared(cloud);
  for (std::size_t i = 0; i < prepared.positions().size(); ++i) {
    if (prepared.positions()[i].z < 0.05F) continue;
    const Vec3 foot = widen(prepared.disks().feet[i]);
    EXPECT_LT(std::hypot(foot.x - 0.0111, foot.y + 0.0123), kSpacing);
    EXPECT_LT(std::fabs(foot.z), 0.001);
  }
}

TEST(DenoisedDisks, AreTheSameWhateverTheThreadsOrderAndScale) {
  Cloud seen = Roof{true}.seen(0.0005);
  const Cloud noisy = plate(0.002, 0.001);
  for (std::size_t i = 0; i < noisy.size(); i += 2) {
    const Vec3 p = widen(noisy.positions[i]);
    add_point({p.x, p.y, p.z - 0.05}, widen(noisy.normals[i]), seen);
  }
  const PreparedPoints once(seen);
  EXPECT_GT(once.disks().seconds.size(), 100U);
  for (const int threads : {1, 2, 3, 16}) {
    set_thread_count(threads);
    expect_same(once.disks(), PreparedPoints(seen).disks());
  }
  set_thread_count(0);
  expect_same(once.disks(), PreparedPoints(testing::permuted(seen)).disks());
  expect_same(once.disks(), PreparedPoints(testing::doubled(seen)).disks());
  for (const int exponent : {-40, 40}) {
    const float scale = std::ldexp(1.0F, exponent);
    Cloud scaled = seen;
    for (Vec3f& p : scaled.positions) p = {scale * p.x, scale * p.y, scale * p.z};
    for (float& r : scaled.radii) r *= scale;
    expect_same(once.disks(), PreparedPoints(scaled).disks(), scale);
  }
}

TEST(DenoisedDisks, AsMeasuredTheyAreThePoints) {
  const PreparedPoints cloud(noisy_wall(0.002, 0.15), Denoising::off);
  EXPECT_EQ(cloud.disks().feet, cloud.positions());
  EXPECT_EQ(cloud.disks().normals, cloud.normals());
  EXPECT_TRUE(cloud.disks().seconds.empty());
}

TEST(DenoisedDisks, ExtremesAreFinite) {
  Noise noise;
  const auto random_normal = [&] { return Vec3{noise.next(1), noise.next(1), noise.next(1)}; };
  std::vector<Cloud> clouds(4);
  for (int k = 0; k < 5000; ++k) {
    add_point({0, 0, 0}, random_normal(), clouds[0]);  // all at one place
    add_point({noise.next(1), noise.next(1), noise.next(1)}, random_normal(), clouds[1]);
    add_point({0.001 * k, 0, 0}, {0, 1, 0}, clouds[2]);  // on a line
  }
  add_point({1, 2, 3}, {0, 0, 1}, clouds[3]);
  for (Cloud& cloud : clouds) {
    for (const float radius : {0.0F, 1e-30F, 0.001F, 10.0F, std::numeric_limits<float>::max()}) {
      std::fill(cloud.radii.begin(), cloud.radii.end(), radius);
      const PreparedPoints prepared(cloud);
      for (const Vec3f& foot : prepared.disks().feet) EXPECT_TRUE(is_finite(foot));
      for (const Vec3f& normal : prepared.disks().normals)
        EXPECT_NEAR(norm(widen(normal)), 1, 1e-3);
      for (const SecondPlane& second : prepared.disks().seconds) {
        EXPECT_TRUE(is_finite(second.foot));
        EXPECT_NEAR(norm(widen(second.normal)), 1, 1e-3);
      }
    }
  }
}

TEST(BallFraction, OfTwoPlanesIsBetweenItsBounds) {
  for (const double a : {0.0, 0.1, 0.5, 0.9, 1.0}) {
    EXPECT_DOUBLE_EQ(fraction_of_both(a, a, 1), a);
    EXPECT_DOUBLE_EQ(fraction_of_both(a, 1, 0.3), a);
    EXPECT_DOUBLE_EQ(fraction_of_both(a, 0, 0.3), 0);
    for (const double b : {0.0, 0.2, 0.7, 1.0}) {
      EXPECT_DOUBLE_EQ(fraction_of_both(a, b, -1), std::max(a + b - 1, 0.0));
      for (const double cosine : {-0.9, -0.2, 0.0, 0.4, 0.8}) {
        const double both = fraction_of_both(a, b, cosine);
        EXPECT_DOUBLE_EQ(both, fraction_of_both(b, a, cosine));
        EXPECT_GE(both, std::max(a + b - 1, 0.0) - 1e-15);
        EXPECT_LE(both, std::min(a, b) + 1e-15);
        // For a wedge through the centre, the exact fraction is the angle between its sides.
        const double wedge = 0.5 - std::acos(cosine) / (2 * std::acos(-1.0));
        EXPECT_NEAR(fraction_of_both(0.5, 0.5, cosine), wedge, 0.06);
      }
    }
  }
}

}  // namespace
}  // namespace vpm
