// Adds up what the bodies of a scene give for one pose of the tool.
#pragma once

#include <vpm/query_types.h>

#include <cstdint>
#include <optional>

#include "libvpm/core/pose.h"
#include "libvpm/measure/tool_piece.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Question to a backend: the pose of one of several tools relative to a body.
struct BodyJob {
  Pose to_body;            // maps coordinates about the tool's centre of mass to the body's frame
  std::uint32_t tool = 0;  // place in the list of tools
};

// Returns what maps coordinates about a tool's centre of mass to the frame of a body.
inline Pose pose_in_body(const Pose& body_to_world, const Pose& tool_to_world,
                         Vec3 center_of_mass) {
  return relative_to(body_to_world, {tool_to_world.rotation, tool_to_world * center_of_mass});
}

// Holds what one body gives for one pose, in the tool's axes and units.
struct BodySum {
  ToolSum sum;
  std::uint32_t boundary = 0, inside = 0;  // spheres
  std::optional<std::uint32_t> points;     // points in spheres, if counted
  std::optional<UnseenSum> unseen;         // of a body that is a camera's (TellsSight)
  bool knows_all_space = false;            // of a closed solid: what it does not hold is free

  friend bool operator==(const BodySum&, const BodySum&) = default;
};

// Holds the sum over bodies. Adds integers exactly, so that bodies in any order give the same bits,
// and as many as there are: ToolSum has room for seven.
class SceneSum {
 public:
  void add(const BodySum& body) {
    const ToolSum& s = body.sum;
    const ToolSum::Sum* const terms[kTerms] = {&s.volume,    &s.force[0],  &s.force[1], &s.force[2],
                                               &s.torque[0], &s.torque[1], &s.torque[2]};
    for (int k = 0; k < kTerms; ++k) terms_[k].add(terms[k]->value);
    boundary_ += body.boundary;
    inside_ += body.inside;
    if (body.points) points_ = points_.value_or(0) + *body.points;
    bodies_that_know_ += body.knows_all_space;
    if (body.unseen) visibility_ = visibility_of(*body.unseen, s.volume.real()), ++cameras_;
    ++bodies_;
  }

  // Returns the answer in SI units and world axes; `rotation` maps the tool's axes to the world's.
  Result result(const ToolModel& tool, const Rotation& rotation) const {
    Result result;
    const double most = bodies_;  // rounding may pass it
    result.volume_fraction = real(0) < most ? real(0) : most;
    result.volume = tool.volume * result.volume_fraction;
    result.wrench.force = tool.volume * (rotation * Vec3{real(1), real(2), real(3)});
    result.wrench.torque =
        tool.volume * (tool.radius * (rotation * Vec3{real(4), real(5), real(6)}));
    result.boundary = boundary_;
    result.inside = inside_;
    result.points = points_;
    if (cameras_ == 1) result.visibility = visibility_;
    if (bodies_ > 0 && bodies_that_know_ == bodies_)
      result.visibility = visibility_of({}, result.volume_fraction);
    return result;
  }

 private:
  // Returns the fractions for a camera's body, or for solids, at which nothing is unseen. The
  // weights of a tool's parts add up to 1 up to rounding: what that leaves was seen free, and what
  // it exceeds is taken from the rest.
  static Visibility visibility_of(const UnseenSum& sum, double volume_fraction) {
    const auto least = [](double a, double b) { return a < b ? a : b; };
    Visibility is;
    double rest = 1 - least(volume_fraction, 1);
    is.out_of_view = least(sum.out_of_view.real(), rest);
    rest -= is.out_of_view;
    is.unseen = least(sum.unseen.real(), rest);
    is.seen_free = rest - is.unseen;
    return is;
  }

  // Sums the halves of 64-bit numbers.
  struct Wide {
    std::int64_t high = 0, low = 0;

    void add(std::int64_t value) {
      high += value >> 32;
      low += value & 0xffffffff;
    }
    // Returns the sum rounded once: both products are exact.
    double real() const { return 0x1p32 * static_cast<double>(high) + static_cast<double>(low); }
  };
  static constexpr int kTerms = 7;

  double real(int term) const { return terms_[term].real() / ToolSum::Sum::kOne; }

  Wide terms_[kTerms];  // volume, force, torque
  std::uint32_t boundary_ = 0, inside_ = 0, bodies_ = 0, cameras_ = 0, bodies_that_know_ = 0;
  std::optional<std::uint32_t> points_;
  Visibility visibility_;  // of the last camera
};

// Returns the answer of a scene of one body.
inline Result result_of(const BodySum& body, const ToolModel& tool, const Rotation& rotation) {
  SceneSum sum;
  sum.add(body);
  return sum.result(tool, rotation);
}

}  // namespace vpm
