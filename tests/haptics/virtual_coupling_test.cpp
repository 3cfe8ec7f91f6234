#include "libvpm/haptics/virtual_coupling.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/synthetic/scenes.h"
#include "tests/query/lattice_model.h"

namespace vpm {
namespace {

constexpr double kStiffness = 500, kDamping = 5, kGyration = 0.08;

CouplingParameters parameters(double rate = 1000) {
  return {kStiffness, kDamping, critical_mass(kStiffness, kDamping), kGyration, rate};
}

Pose at(Vec3 place, Vec3 turn = {}) {
  return {rotation_from_vector(turn), place};
}

// Returns a smooth path without a period that the steps could match.
Pose wander(double t) {
  return at({0.1 * std::sin(2.1 * t), 0.05 * std::sin(3.7 * t + 1), 0.08 * std::cos(1.3 * t)},
            {0.4 * std::sin(1.7 * t), 0.3 * std::cos(2.3 * t), 0.2 * std::sin(0.9 * t)});
}

// Returns the force of a floor z = 0 that pushes a point up.
Wrench floor_push(const Pose& tool, double stiffness) {
  return {{0, 0, stiffness * std::max(0.0, -tool.translation.z)}, {}};
}

TEST(VirtualCoupling, ComesToTheDevice) {
  VirtualCoupling coupling(parameters(), {0.01, 0.02, 0}, at({0, 0, 0}));
  const Pose device = at({0.1, 0, 0}, {0, 0, 0.5});
  for (int k = 0; k < 400; ++k) coupling.advance(device, {});
  EXPECT_LE(norm(coupling.tool().translation - device.translation), 1e-6);
  EXPECT_LE(norm(rotation_vector(device.rotation * transpose(coupling.tool().rotation))), 1e-5);
}

TEST(VirtualCoupling, ComesBackWithoutOvershootWhenLetGo) {
  VirtualCoupling coupling(parameters(), {}, at({}));
  for (int k = 0; k < 400; ++k) coupling.advance(at({}), {{0, 0, 10}, {}});
  double before = coupling.tool().translation.z;
  EXPECT_NEAR(before, 10 / kStiffness, 1e-6);
  for (int k = 0; k < 400; ++k) {
    coupling.advance(at({}), {});
    const double z = coupling.tool().translation.z;
    EXPECT_LE(z, before);
    EXPECT_GE(z, 0);
    before = z;
  }
}

TEST(VirtualCoupling, LosesEnergyAndNeverMakesAnyInFreeSpace) {
  VirtualCoupling coupling(parameters(), {}, wander(0));
  double lost = 0;
  for (int k = 1; k <= 5000; ++k) {
    coupling.advance(wander(k * 1e-3), {});
    const CouplingEnergy& e = coupling.energy();
    EXPECT_EQ(e.absorbed, 0);
    EXPECT_GE(e.lost, lost - 1e-9) << k;
    EXPECT_GE(e.supplied, -1e-9) << k;
    lost = e.lost;
  }
  EXPECT_GT(coupling.energy().supplied, 0);
}

// Energy that comes out was put in or stored before, however the tool hits the floor.
TEST(VirtualCoupling, IsPassiveAgainstASampledFloor) {
  for (const double stiffness : {1e3, 1e4, 3e4}) {
    VirtualCoupling coupling(parameters(), {}, at({0, 0, 0.02}));
    const double mass = parameters().mass;
    double fastest = 0;
    std::mt19937_64 draw(7);
    for (int k = 1; k <= 20000; ++k) {
      const double jitter = 1e-4 * (static_cast<double>(draw() >> 11) * 0x1p-53 - 0.5);
      const Pose device = at({0, 0, 0.02 * std::cos(9e-3 * k) + jitter});
      const Vec3 before = coupling.tool().translation;
      coupling.advance(device, floor_push(coupling.tool(), stiffness));
      fastest = std::max(fastest, 1e3 * norm(coupling.tool().translation - before));
      // One step can make some energy before the controller knows.
      EXPECT_GE(coupling.energy().supplied, -mass * fastest * fastest) << stiffness << ' ' << k;
    }
  }
}

TEST(VirtualCoupling, RestsWhereSpringAndContactBalance) {
  VirtualCoupling coupling(parameters(), {}, at({0, 0, 0.02}));
  Wrench felt;
  for (int k = 0; k < 3000; ++k)
    felt = coupling.advance(at({0, 0, -0.01}), floor_push(coupling.tool(), 2000));
  const double depth = -coupling.tool().translation.z;
  EXPECT_NEAR(depth, 0.01 * kStiffness / (kStiffness + 2000), 1e-9);
  EXPECT_NEAR(felt.force.z, 2000 * depth, 1e-6);
}

// Runs the implicit step against a linear contact without the passivity controller. Returns the
// swing that is left after 4000 steps from 1 mm.
double swing_without_controller(const CouplingParameters& p, double contact) {
  const double h = 1 / p.rate, inert = p.mass + h * p.damping + h * h * p.stiffness;
  double x = 1e-3, v = 0;
  for (int k = 0; k < 4000; ++k) {
    v = (p.mass * v - h * (p.stiffness + contact) * x) / inert;
    x += h * v;
  }
  return std::abs(x);
}

TEST(VirtualCoupling, KnowsWhichContactsItsStepsAreStableAgainst) {
  const double limit = coupling_limits(parameters()).contact_stiffness;
  EXPECT_LE(swing_without_controller(parameters(), 0.99 * limit), 1e-9);
  EXPECT_GE(swing_without_controller(parameters(), 1.01 * limit), 1);
}

TEST(VirtualCoupling, ThePassivityControllerReachesABitBeyondThat) {
  const double stiffness = 1.1 * coupling_limits(parameters()).contact_stiffness;
  VirtualCoupling coupling(parameters(), {}, at({}));
  for (int k = 0; k < 4000; ++k) {
    const double push = k == 0 ? 1 : 0;
    coupling.advance(at({}), {{0, 0, push - stiffness * coupling.tool().translation.z}, {}});
  }
  EXPECT_LE(norm(coupling.tool().translation), 1e-6);
}

TEST(VirtualCoupling, KnowsTheRateThatAContactNeeds) {
  EXPECT_EQ(stable_rate(parameters(), kStiffness), 0);
  const double rate = stable_rate(parameters(), 3e4);
  EXPECT_NEAR(coupling_limits(parameters(rate)).contact_stiffness, 3e4, 1e-6);
}

TEST(VirtualCoupling, RefusesWhatIsNoCoupling) {
  CouplingParameters wrong = parameters();
  wrong.damping = 0;
  EXPECT_THROW(VirtualCoupling(wrong, {}, {}), Error);
  wrong = parameters();
  wrong.rate = std::nan("");
  EXPECT_THROW(VirtualCoupling(wrong, {}, {}), Error);
}

TEST(VirtualCoupling, RefusesToStartAtNoPose) {
  Pose start = at({0, 0, std::nan("")});
  EXPECT_THROW(VirtualCoupling(parameters(), {}, start), Error);
  start = at({0, 0, 0});
  start.rotation.row0.x = 2;
  EXPECT_THROW(VirtualCoupling(parameters(), {}, start), Error);
  EXPECT_THROW(VirtualCoupling(parameters(), {0, std::nan(""), 0}, at({0, 0, 0})), Error);
}

// One bad sample of a device's driver, or of a measure, must not stop the coupling.
TEST(VirtualCoupling, GoesOnAfterASampleThatIsRefused) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = HUGE_VAL;
  VirtualCoupling coupling(parameters(), {0.01, 0, 0}, at({0, 0, 0})), other = coupling;
  for (int k = 0; k < 100; ++k) {
    for (const double bad : {kNan, kInf, 1e300, -1e61}) {
      EXPECT_THROW(coupling.advance(wander(0.001 * k), {{}, {bad, 0, 0}}), Error);
      EXPECT_THROW(coupling.advance(wander(0.001 * k), {{0, bad, 0}, {}}), Error);
      EXPECT_THROW(coupling.advance(at({bad, 0, 0}), {}), Error);
    }
    Pose sheared = wander(0.001 * k);
    sheared.rotation.row0.x += 0.1;
    EXPECT_THROW(coupling.advance(sheared, {}), Error);
    const Wrench felt = coupling.advance(wander(0.001 * k), {});
    EXPECT_EQ(felt.force, other.advance(wander(0.001 * k), {}).force);
    EXPECT_EQ(coupling.energy().supplied, other.energy().supplied);
  }
}

TEST(VirtualCoupling, HoldsACubeInTheWallWhereForcesBalance) {
  constexpr double kEdge = 0.2, kPerVolume = 2e4;  // N/m^3
  const ToolModel tool = testing::lattice_cube(kEdge, 6, 4);
  EXPECT_NEAR(radius_of_gyration(tool), kEdge / std::sqrt(6), 1e-3);
  const synthetic::Scene scene = synthetic::make_scene("wall");
  const AnyBody cloud(testing::see(scene));
  QueryOptions options;
  options.stiffness = kPerVolume;
  ToolQuery query(tool, options);
  const CouplingParameters p{kStiffness, kDamping, 0.2, radius_of_gyration(tool), 1000};
  VirtualCoupling coupling(p, tool.center_of_mass, at({0, 0, 0.8}));
  Result contact;
  Pose device;
  for (int k = 0; k < 1500; ++k) {
    device = at({0, 0, 0.8 + 0.15 * std::min(1.0, k / 1000.0)});
    contact = query.run(cloud, coupling.tool());
    coupling.advance(device, contact.wrench);
  }
  const double depth = coupling.tool().translation.z + kEdge / 2 - 1;
  ASSERT_GT(depth, 0);
  const double pull = kStiffness * (device.translation.z - coupling.tool().translation.z);
  EXPECT_NEAR(contact.wrench.force.z, -pull, 0.01 * pull);
  EXPECT_NEAR(kPerVolume * kEdge * kEdge * depth, pull, 0.02 * pull);
}

// What one column of the page's table says about a cube held against a wall.
class WorkedExample {
 public:
  static constexpr double kEdge = 0.1, kContact = 1000, kBeyond = 0.009;  // m, N/m, m
  static constexpr double kArea = kEdge * kEdge, kPerVolume = kContact / kArea;

  explicit WorkedExample(double damping)
      : coupling_{500, damping, critical_mass(500, damping), kEdge / std::sqrt(6), 1000} {
    const ToolModel tool = testing::lattice_cube(kEdge, 6, 10);
    const AnyBody wall(testing::see(synthetic::make_scene("wall")));  // at a depth of 1 m
    QueryOptions options;
    options.stiffness = kPerVolume;
    ToolQuery query(tool, options);
    const Pose touching = at({0, 0, 1 - kEdge / 2});
    VirtualCoupling held(coupling_, tool.center_of_mass, touching);
    const Pose hand = at({0, 0, touching.translation.z + kBeyond});
    for (int k = 0; k < 2000; ++k) felt_ = held.advance(hand, query.run(wall, held.tool()).wrench);
    depth_ = held.tool().translation.z - touching.translation.z;
  }

  // Returns the rows of the column: numbers and units as the page writes them.
  std::vector<std::string> rows() const {
    const CouplingLimits limits = coupling_limits(coupling_);
    return {text(coupling_.mass, 3, "kg"),
            text(limits.contact_stiffness, 5, "N/m"),
            text(limits.contact_stiffness / kArea, 3, "N/m³"),
            text(stable_rate(coupling_, kContact), 3, "1/s"),
            text(limits.device_damping, 3, "N s/m"),
            text(1000 * depth_, 2, "mm"),
            text(-felt_.force.z, 2, "N"),
            text(kPerVolume * kEdge * kEdge * kEdge, 3, "N")};
  }

 private:
  static std::string text(double number, int digits, const char* unit) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*g %s", digits, number, unit);
    return text;
  }

  CouplingParameters coupling_;
  double depth_ = 0;
  Wrench felt_;
};

TEST(VirtualCoupling, ThePageComputesItsExampleRight) {
  std::ifstream file(std::string(VPM_SOURCE_DIR) + "/libvpm/haptics/README.md");
  const std::string page(std::istreambuf_iterator<char>(file), {});
  const std::vector<std::string> one = WorkedExample(5).rows(), other = WorkedExample(0.5).rows();
  for (std::size_t row = 0; row < one.size(); ++row) {
    const std::string cells = "| " + one[row] + " | " + other[row] + " |";
    EXPECT_NE(page.find(cells), std::string::npos) << "the page has no row " << cells;
  }
}

}  // namespace
}  // namespace vpm
