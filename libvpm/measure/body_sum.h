// Adds up what the bodies of a scene give for one pose of the tool.
#pragma once

#include <vpm/query_types.h>

#include <algorithm>
#include <cmath>
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
VPM_HD inline Pose pose_in_body(const Pose& body_to_world, const Pose& tool_to_world,
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
  // Variance of the volume, in squares of the tool's, if it is asked for and known; 0 of a solid.
  std::optional<ToolSum::Sum> variance{};
  // Of points without a camera (TellsUnknown): the part of which nobody knows whether it is inside.
  std::optional<ToolSum::Sum> unknown{};

  friend bool operator==(const BodySum&, const BodySum&) = default;
};

// Holds the sum over bodies. Adds integers exactly, so that bodies in any order give the same bits,
// and as many as there are: ToolSum has room for seven.
class SceneSum {
 public:
  void add(const BodySum& body) {
    add(body.sum, body.boundary, body.inside);
    if (body.points) counts_points_ = true, points_ += *body.points;
    bodies_that_know_ += body.knows_all_space;
    if (body.unseen) see(*body.unseen, body.sum);
    if (body.unknown) know(*body.unknown, body.sum);
    if (!body.variance) return;
    variance_.add(body.variance->value);
    ++bodies_of_variance_;
  }
  // Adds a body of which nothing else is known.
  VPM_HD void add(const ToolSum& s, std::uint32_t boundary, std::uint32_t inside) {
    const ToolSum::Sum* const terms[kTerms] = {&s.volume,    &s.force[0],  &s.force[1], &s.force[2],
                                               &s.torque[0], &s.torque[1], &s.torque[2]};
    for (int k = 0; k < kTerms; ++k) terms_[k].add(terms[k]->value);
    boundary_ += boundary;
    inside_ += inside;
    ++bodies_;
  }
  // Adds what the camera sees whose body gave `sum`.
  VPM_HD void see(const UnseenSum& unseen, const ToolSum& sum) {
    visibility_ = visibility_of(unseen, sum.volume.real());
    ++cameras_;
  }
  // Adds what points know whose body gave `sum`, all but the part `unknown`. What a camera sees
  // goes before it.
  VPM_HD void know(ToolSum::Sum unknown, const ToolSum& sum) {
    if (cameras_ == 0) visibility_ = visibility_of({unknown, {}}, sum.volume.real());
    ++clouds_;
  }

  // Returns the part of the tool that is inside.
  VPM_HD double volume_fraction() const {
    const double most = bodies_;  // rounding may pass it
    return real(0) < most ? real(0) : most;
  }
  // Returns force and torque in world axes, for a stiffness of N/m^3; `rotation` maps the axes of
  // the tool, of this volume and radius, to the world's.
  VPM_HD Wrench wrench(double tool_volume, double tool_radius, const Rotation& rotation,
                       double stiffness) const {
    const Vec3 force = tool_volume * (rotation * Vec3{real(1), real(2), real(3)});
    const Vec3 torque = tool_volume * (tool_radius * (rotation * Vec3{real(4), real(5), real(6)}));
    return {stiffness * force, stiffness * torque};
  }
  VPM_HD std::uint32_t boundary() const { return boundary_; }
  VPM_HD std::uint32_t inside() const { return inside_; }

  // True if the scene tells what is seen of the tool: if it has one camera, or none but one cloud
  // of points, or only closed solids.
  VPM_HD bool tells_sight() const {
    return cameras_ == 1 || (cameras_ == 0 && clouds_ == 1) || knows_all_space();
  }
  VPM_HD Visibility visibility() const {
    return knows_all_space() ? visibility_of({}, volume_fraction()) : visibility_;
  }

  // Returns the bounds, m^3, between which the true volume inside all bodies lies 95 times of 100;
  // nothing if a body does not tell its variance. The error is a sum of many parts, so it is
  // taken to be normally distributed.
  std::optional<Interval> volume_interval(double tool_volume) const {
    constexpr double kDeviations = 1.96;
    if (bodies_of_variance_ < bodies_) return std::nullopt;
    const double volume = volume_fraction(), most = bodies_,
                 half = kDeviations * std::sqrt(variance_.real() / ToolSum::Sum::kOne);
    return Interval{tool_volume * std::max(volume - half, 0.0),
                    tool_volume * std::min(volume + half, most)};
  }

  // Returns the answer in SI units and world axes.
  Result result(const ToolModel& tool, const Rotation& rotation, double stiffness = 1) const {
    Result result;
    result.volume_fraction = volume_fraction();
    result.volume = tool.volume * result.volume_fraction;
    result.wrench = wrench(tool.volume, tool.radius, rotation, stiffness);
    result.boundary = boundary_;
    result.inside = inside_;
    if (counts_points_) result.points = points_;
    if (tells_sight()) result.visibility = visibility();
    return result;
  }

 private:
  // Returns the fractions for a camera's body or points, or for solids, at which nothing is unseen.
  // The weights of a tool's parts add up to 1 up to rounding: what that leaves was seen free, and
  // what it exceeds is taken from the rest.
  VPM_HD static Visibility visibility_of(const UnseenSum& sum, double volume_fraction) {
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

    VPM_HD void add(std::int64_t value) {
      high += value >> 32;
      low += value & 0xffffffff;
    }
    // Returns the sum rounded once: both products are exact.
    VPM_HD double real() const {
      return 0x1p32 * static_cast<double>(high) + static_cast<double>(low);
    }
  };
  static constexpr int kTerms = 7;

  VPM_HD double real(int term) const { return terms_[term].real() / ToolSum::Sum::kOne; }
  VPM_HD bool knows_all_space() const { return bodies_ > 0 && bodies_that_know_ == bodies_; }

  Wide terms_[kTerms];  // volume, force, torque
  Wide variance_;
  std::uint32_t boundary_ = 0, inside_ = 0, bodies_ = 0, cameras_ = 0, clouds_ = 0,
                bodies_that_know_ = 0, bodies_of_variance_ = 0;
  std::uint32_t points_ = 0;
  bool counts_points_ = false;
  Visibility visibility_;  // of the last camera, or without one of the last points
};

// Returns the answer of a scene of one body.
inline Result result_of(const BodySum& body, const ToolModel& tool, const Rotation& rotation) {
  SceneSum sum;
  sum.add(body);
  return sum.result(tool, rotation);
}

}  // namespace vpm
