// two-links [FOLDER]: a hand holds a link with a peg, and a second link hangs on the peg by its
// hole and swings under gravity, in 3000 steps of 1 ms. The hand feels a virtual coupling; peg and
// hole part by the force of the depth in what they share, and by a damper that acts on its volume.
// Prints where the energy went: what the contact holds is the work that was done against its force,
// which comes back to nothing wherever the two part, or the force would be that of no energy. With
// a FOLDER, links.csv there has each fifth step, which scripts/plot_links.py draws.
#include <vpm/error.h>
#include <vpm/solid.h>
#include <vpm/virtual_coupling.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

namespace {

using vpm::Pose, vpm::Vec3;

constexpr Vec3 operator+(Vec3 a, Vec3 b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
constexpr Vec3 operator*(double s, Vec3 v) {
  return {s * v.x, s * v.y, s * v.z};
}
constexpr Vec3 operator-(Vec3 a, Vec3 b) {
  return a + -1.0 * b;
}
constexpr double dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double length(Vec3 v) {
  return std::sqrt(dot(v, v));
}
Vec3 place(const Pose& pose, Vec3 v) {
  const auto& [row0, row1, row2] = pose.rotation;
  return Vec3{dot(row0, v), dot(row1, v), dot(row2, v)} + pose.translation;
}

constexpr int kSteps = 3000;
constexpr double kStep = 1e-3, kGravity = 9.81;            // s, m/s^2
constexpr double kPeg = 4.5e-3, kHole = 5e-3;              // radii, m
constexpr double kStiffness = 4e8, kDamping = 2e9;         // of the contact: N/m^3, N s/m^5
constexpr double kDensity = 2700, kGyration = 0.035;       // kg/m^3 and m, of both links
constexpr double kHandStiffness = 800, kHandDamping = 15;  // N/m, N s/m
constexpr double kSwing = 40 * std::numbers::pi / 180;     // of the second link at first, rad
constexpr double kHandRests = 1.5, kHandMoves = 1;         // s

struct Mesh {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

// Adds what lies between y = low and y = high, in the outline whose corner at each angle about the
// y axis is reach(cosine, sine) away, and outside of a hole, unless its radius is 0.
void add_prism(Mesh& mesh, const auto& reach, double hole, double low, double high) {
  constexpr std::uint32_t kSides = 32;
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / kSides;
    const double c = std::cos(angle), s = std::sin(angle);
    for (const double y : {low, high})
      for (const double r : {reach(c, s), hole}) mesh.vertices.push_back({r * c, y, r * s});
  }
  const auto at = [&](std::uint32_t k, std::uint32_t corner) {
    const bool is_middle = hole == 0 && corner % 2 == 1;  // one vertex for all sides
    return first + (is_middle ? 0 : 4 * (k % kSides)) + corner;
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  };
  for (std::uint32_t k = 0; k < kSides; ++k)
    for (const auto& [a, b] : {std::array{0U, 2U}, {2U, 3U}, {3U, 1U}, {1U, 0U}}) {
      if (hole == 0 && a == 3) continue;
      add(at(k, a), at(k, b), at(k + 1, b));
      add(at(k, a), at(k + 1, b), at(k + 1, a));
    }
}

// Returns the outline of a bar from x0 < 0 to x1 > 0, 24 mm wide.
auto bar(double x0, double x1) {
  return [=](double c, double s) { return std::min((c > 0 ? x1 : x0) / c, 0.012 / std::abs(s)); };
}

vpm::SolidBody body_of(const Mesh& mesh) {
  return vpm::SolidBody(vpm::SolidMesh::from_triangles(mesh.vertices, mesh.triangles));
}

auto disk(double radius) {
  return [=](double, double) { return radius; };
}

// The link in the hand, with a peg about its y axis that has a head. Where its prisms cross, their
// volume counts once.
vpm::SolidBody link_with_peg() {
  Mesh mesh;
  add_prism(mesh, bar(-0.1, 0.012), 0, -0.008, 0);
  add_prism(mesh, disk(kPeg), 0, -0.004, 0.014);
  add_prism(mesh, disk(0.007), 0, 0.013, 0.016);
  return body_of(mesh);
}

vpm::SolidBody link_with_hole() {
  Mesh mesh;
  add_prism(mesh, bar(-0.012, 0.1), kHole, 0.002, 0.012);
  return body_of(mesh);
}

// A rigid body with equal inertia about all axes, as the virtual coupling has it.
struct Link {
  explicit Link(const vpm::SolidBody& b) : body(b), mass(kDensity * b.volume()) {}

  Vec3 center() const { return place(pose, body.center_of_mass()); }
  Vec3 velocity_at(Vec3 x) const { return velocity + cross(spin, x - center()); }
  double inertia() const { return mass * kGyration * kGyration; }
  double kinetic() const {
    return 0.5 * (mass * dot(velocity, velocity) + inertia() * dot(spin, spin));
  }
  double height_energy() const { return mass * kGravity * center().z; }

  // Makes a step under gravity and a wrench about the centre (semi-implicit Euler).
  void step(const vpm::Wrench& w) {
    velocity = velocity + kStep * ((1 / mass) * w.force + Vec3{0, 0, -kGravity});
    spin = spin + (kStep / inertia()) * w.torque;
    const Vec3 moved = center() + kStep * velocity;
    const double angle = kStep * length(spin), half = std::sin(0.5 * angle);
    const Vec3 axis = angle > 0 ? (kStep / angle) * spin : Vec3{1, 0, 0};
    const Pose turn{vpm::rotation_from_quaternion(
                        {half * axis.x, half * axis.y, half * axis.z, std::cos(0.5 * angle)}),
                    {}};
    const auto& [r0, r1, r2] = pose.rotation;
    const Vec3 x = place(turn, {r0.x, r1.x, r2.x}), y = place(turn, {r0.y, r1.y, r2.y}),
               z = place(turn, {r0.z, r1.z, r2.z});
    pose.rotation = vpm::rotation_from_matrix({x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z});
    pose.translation = {};
    pose.translation = moved - center();
  }

  vpm::SolidBody body;
  double mass;
  Pose pose = {};
  Vec3 velocity = {}, spin = {};
};

// Force and torque on the first link, the torque about the place, as the depth has them and with
// the damper, whose power is `damped`, W.
struct Contact {
  Vec3 place;
  vpm::Wrench of_depth, all;
  double damped = 0;
};

// Adds to the wrench of the overlap a damper: a pressure that grows with the rate of the volume,
// whose gradient is exact (`area` where the first link moves, `turn` where it turns).
Contact contact_of(const vpm::Overlap& shared, const Link& a, const Link& b) {
  const Vec3 closing = a.velocity_at(shared.centroid) - b.velocity_at(shared.centroid);
  const double rate = dot(shared.area, closing) + dot(shared.turn, a.spin - b.spin);
  const auto& [force, torque] = shared.wrench;
  return {shared.centroid,
          shared.wrench,
          {force - kDamping * rate * shared.area, torque - kDamping * rate * shared.turn},
          kDamping * rate * rate};
}

vpm::Wrench wrench_about(Vec3 center, Vec3 place, const vpm::Wrench& wrench, double sign) {
  return {sign * wrench.force, sign * (wrench.torque + cross(place - center, wrench.force))};
}

// The hand rests, moves 30 mm aside and up and back within a second, and rests again.
Pose hand_at(double time) {
  const double phase = std::clamp((time - kHandRests) / kHandMoves, 0.0, 1.0);
  const double way = 0.015 * (1 - std::cos(2 * std::numbers::pi * phase));
  return {{}, {way, 0, way}};
}

// Energies, J: given by hand and gravity since the start; of the second link's motion; of the first
// one's motion and the coupling's spring; of the contact; taken by the coupling and by the
// contact's damper. The steps' error is left.
struct Account {
  double given = 0, swinging = 0, held = 0, squeezed = 0, hand_damped = 0, contact_damped = 0,
         left = 0;
};

// Two links, the hand, and their energies.
class Hinge {
 public:
  Hinge()
      : held_(link_with_peg()),
        hung_(link_with_hole()),
        overlap_(held_.body, hung_.body, {.stiffness = kStiffness}),
        hand_({kHandStiffness, kHandDamping, held_.mass, kGyration, 1 / kStep},
              held_.body.center_of_mass(), {}) {
    const double half = 0.5 * (0.5 * std::numbers::pi - kSwing);
    hung_.pose = {vpm::rotation_from_quaternion({0, std::sin(half), 0, std::cos(half)}),
                  {0, 0, kPeg - kHole}};
    start_ = held_.height_energy() + hung_.height_energy();
  }

  // Accounts for the energies, then makes a step.
  void step(double time) {
    const Contact contact = contact_of(overlap_.run(held_.pose, hung_.pose), held_, hung_);
    add_work(held_, contact, 1, before_[0]);
    add_work(hung_, contact, -1, before_[1]);
    keep_account();
    vpm::Wrench on_held = wrench_about(held_.center(), contact.place, contact.all, 1);
    on_held.force.z -= held_.mass * kGravity;
    hung_.step(wrench_about(hung_.center(), contact.place, contact.all, -1));
    const Link before = held_;
    hand_.advance(hand_at(time), on_held);
    held_.pose = hand_.tool();
    held_.velocity = (1 / kStep) * (held_.center() - before.center());
    held_.spin = spin_between(before.pose, held_.pose);
    contact_damped_ += kStep * contact.damped;
  }

  const Account& account() const { return account_; }
  // Returns the angle of the second link from hanging, rad.
  double swing() const {
    const Vec3 down = hung_.center() - held_.pose.translation;
    return std::atan2(down.x, -down.z);
  }
  const Pose& held() const { return held_.pose; }
  // Returns the time of a small swing about the peg, s.
  double small_swing() const {
    const double arm = hung_.body.center_of_mass().x;
    return 2 * std::numbers::pi * std::sqrt((kGyration * kGyration + arm * arm) / (kGravity * arm));
  }

 private:
  double height() const { return held_.height_energy() + hung_.height_energy(); }

  // Adds the work against the depth's wrench on a link along the step that led here: by its motion,
  // and the mean of the wrenches at both ends about its centre.
  void add_work(const Link& link, const Contact& contact, double sign, vpm::Wrench& before) {
    const vpm::Wrench now = wrench_about(link.center(), contact.place, contact.of_depth, sign);
    squeezed_ -=
        0.5 * kStep *
        (dot(before.force + now.force, link.velocity) + dot(before.torque + now.torque, link.spin));
    before = now;
  }

  void keep_account() {
    const vpm::CouplingEnergy hand = hand_.energy();
    Account& a = account_;
    a = {hand.supplied + start_ - height(),
         hung_.kinetic(),
         hand.stored,
         squeezed_,
         hand.dissipated + hand.lost,
         contact_damped_,
         0};
    a.left = a.given - a.swinging - a.held - a.squeezed - a.hand_damped - a.contact_damped;
  }

  static Vec3 spin_between(const Pose& from, const Pose& to) {
    const auto &a = from.rotation, &b = to.rotation;
    Vec3 sum;
    for (const auto& [u, v] :
         {std::array{Vec3{a.row0.x, a.row1.x, a.row2.x}, Vec3{b.row0.x, b.row1.x, b.row2.x}},
          {Vec3{a.row0.y, a.row1.y, a.row2.y}, Vec3{b.row0.y, b.row1.y, b.row2.y}},
          {Vec3{a.row0.z, a.row1.z, a.row2.z}, Vec3{b.row0.z, b.row1.z, b.row2.z}}})
      sum = sum + cross(u, v);
    return (0.5 / kStep) * sum;
  }

  Link held_, hung_;
  vpm::OverlapQuery overlap_;
  vpm::VirtualCoupling hand_;
  double start_ = 0, contact_damped_ = 0, squeezed_ = 0;
  std::array<vpm::Wrench, 2> before_ = {};  // of the depth on each link, at the step before
  Account account_;
};

void write(std::FILE* table, double time, const Hinge& hinge) {
  const Account& a = hinge.account();
  const Vec3 peg = hinge.held().translation;
  std::fprintf(table, "%.3f,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", time, peg.x,
               peg.z, hinge.swing(), a.given, a.swinging, a.held, a.squeezed, a.hand_damped,
               a.contact_damped, a.left);
}

void run(std::FILE* table) {
  Hinge hinge;
  double most_left = 0, most_given = 0, before = kSwing, first = 0, last = 0;
  int crossings = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int step = 0; step < kSteps; ++step) {
    const double time = step * kStep;
    hinge.step(time);
    most_left = std::max(most_left, std::abs(hinge.account().left));
    most_given = std::max(most_given, hinge.account().given);
    const double swing = hinge.swing();
    if (time < kHandRests && before * swing < 0) {
      last = time - kStep * swing / (swing - before);
      if (crossings++ == 0) first = last;
    }
    before = swing;
    if (table != nullptr && step % 5 == 0) write(table, time, hinge);
  }
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  const Account& a = hinge.account();
  std::printf("%d steps of %.0f us; a swing takes %.3f s, a small one in theory %.3f s\n", kSteps,
              1e6 * taken.count() / kSteps, 2 * (last - first) / (crossings - 1),
              hinge.small_swing());
  std::printf(
      "given %.3f mJ = swinging %.3f + held %.3f + in the contact %.3f + damped by the coupling "
      "%.3f "
      "and by the contact %.3f + left %.3f\n",
      1e3 * a.given, 1e3 * a.swinging, 1e3 * a.held, 1e3 * a.squeezed, 1e3 * a.hand_damped,
      1e3 * a.contact_damped, 1e3 * a.left);
  std::printf("at most %.3g %% of what was given was left over\n", 100 * most_left / most_given);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> table(
        argc > 1 ? std::fopen((std::string(argv[1]) + "/links.csv").c_str(), "w") : nullptr,
        &std::fclose);
    if (argc > 1 && !table) {
      std::fprintf(stderr, "two-links: cannot write into %s\n", argv[1]);
      return 4;
    }
    if (table)
      std::fputs(
          "time,peg_x,peg_z,swing,given,swinging,held,squeezed,hand_damped,contact_damped,left\n",
          table.get());
    run(table.get());
    return 0;
  } catch (const vpm::Error& error) {
    std::fprintf(stderr, "two-links: %s\n", error.what());
    return 1;
  }
}
