// How what of a tool is behind the surface changes as the tool moves, to first order: the stiffness
// matrix of a contact, with what turning the forces themselves adds.
//
// Where planes with unit normal n cross samples at a, and g = -dw/dh of a sample's weight w behind
// the plane by the plane's height h, every sample is a spring g along n at a: its wrench (n, a x n)
// changes by g (n, a x n) (n, a x n)^T times the motion. README.md, "Coherent poses".
#pragma once

#include "libvpm/core/matrix3.h"
#include "libvpm/query/crossing_plane.h"
#include "libvpm/query/tool_sum.h"

namespace vpm {

// A small motion of the surface as the tool sees it: x -> x + shift + turn x x.
struct SmallMotion {
  Vec3 shift, turn;  // of the tool's reach; radians
};

// Of samples that one plane crosses, arms about the tool's centre of mass in metres.
struct CrossedSlopes {
  double rate = 0;  // sum of g, 1/m
  Vec3 turn;        // of g a x n
  Matrix3 stiff;    // of g (a x n) (a x n)^T, m
};

class ContactSlopes {
 public:
  // What one plane crosses.
  void add_crossed(Vec3 normal, const CrossedSums& sums, const CrossedSlopes& slopes,
                   double inverse_reach) {
    const double rate = slopes.rate / inverse_reach;
    const Vec3 pulled = rate * normal;
    rate_ += rate;
    part_by_shift_ += pulled;
    part_by_turn_ += slopes.turn;
    force_by_shift_ += outer_product(normal, pulled);
    force_by_turn_ += outer_product(normal, slopes.turn);
    torque_by_turn_ += inverse_reach * slopes.stiff;
    virial_ += outer_product(normal, inverse_reach * sums.moment);
  }
  // What is wholly behind, pushed by this force.
  void add_pushed(Vec3 force, Vec3 arm) { virial_ += outer_product(force, arm); }

  // How much of the tool's volume passes the surface at most where no place of the tool moves
  // further than this, in its reaches.
  double most_passing(double way) const { return rate_ * way; }
  // `force`: of all that was added.
  SumChange change(const SmallMotion& by, Vec3 force) const {
    const Vec3 shift = by.shift, turn = by.turn;
    return {
        dot(part_by_shift_, shift) + dot(part_by_turn_, turn),
        force_by_shift_ * shift + force_by_turn_ * turn + cross(turn, force),
        shift * force_by_turn_ + torque_by_turn_ * turn + (trace(virial_) * turn - virial_ * turn)};
  }

 private:
  double rate_ = 0;
  Vec3 part_by_shift_, part_by_turn_;
  // Torques change by a shift as forces by a turn.
  Matrix3 force_by_shift_, force_by_turn_, torque_by_turn_;
  Matrix3 virial_;  // sum of forces times arms
};

}  // namespace vpm
