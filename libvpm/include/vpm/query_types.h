// Declares what a query is asked, and what it answers.
#pragma once

#include <vpm/device.h>
#include <vpm/pose.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace vpm {

// refined: each part of the tool belongs to its nearest sphere, surfaces are planes within it, and
// noise is taken out. paper: the algorithm as printed in 2017.
enum class Measure { refined, paper };

// Says what counts of the places that a depth image does not show. near: those at most the tool
// radius behind what it shows, and further behind those that a surface which cuts the tool
// supports. solid: all of them. The tool radius is the greatest distance of the tool from its
// centre of mass.
enum class Shadows { near, solid };

struct QueryOptions {
  Measure measure = Measure::refined;
  std::uint32_t level = 0;  // number of spheres; 0: the finest level of the tool
  Device device = {};       // the tool's level is copied there
  // One motion: a tool that passes wholly behind the surface stays inside until it comes out.
  // Refined measure on the CPU only.
  bool coherent = false;
  Shadows shadows = Shadows::near;  // solid: refined measure, in depth images
  double stiffness = 1;             // N/m^3: the wrench is in N and N m; 1 leaves it in m^3 and m^4
  // Contacts of a single pose that Query::contacts() lists by themselves, all others in one more;
  // 0: none are found, in less time. Refined measure on the CPU only. So that contacts can add up
  // to force and torque, these are rounded to 2^-46 of volume x stiffness (x tool radius).
  std::uint32_t contacts = 0;
  bool interval = false;  // finds Result::volume_interval; refined measure on the CPU only
};

// Question of a batch: a pose (tool to world) of one of the query's tools.
struct Job {
  Pose pose;
  std::uint32_t tool = 0;  // place in the list of tools
  // Poses of the scene's solids, mesh to world, in the order of its bodies; none: where they were
  // made. Refers to the caller's memory.
  std::span<const Pose> solids = {};
};

// State of a sphere of the tool at the pose last asked: free, cut by the surface, or behind it.
enum class SphereState : std::uint8_t { outside = 0, boundary = 1, inside = 2 };

// Force and torque in world axes, the torque about the tool's centre of mass; both push the tool
// into free space. Units are N and N m, or m^3 and m^4 if QueryOptions::stiffness is 1.
struct Wrench {
  Vec3 force, torque;
  friend constexpr bool operator==(const Wrench&, const Wrench&) = default;
};

// A contact: a connected patch of what two bodies a and b share; in a scene a is the tool and b one
// body. Contacts come by volume, largest first (then by the centroid's x, y and z, then by the
// body's place); the last one sums all that were not asked for. Volumes add up to that of the whole
// in any order, in the same bits, and so do forces and torques. Two solids give the same contacts
// in the same bits, and swapped with the signs of normal and wrench turned; a scene gives the same
// bits for any order of its bodies. Along a path volume, centroid and wrench of a contact are
// continuous as those of the whole are, but where contacts merge or split; its place in the list
// may change, the nearest centroid is the same contact. Its hollows are part of it.
//
// What two solids share hangs together where their meshes say so, exactly. Of images and points,
// the tool's cells that count do where the centres of their samples behind the surface are nearer
// than an eighth of the tool radius, and not where they are a quarter apart, but for samples larger
// than a sixteenth, which reach further; a cell is never divided between contacts.
struct Contact {
  // Place of a contact that sums patches of several bodies.
  static constexpr std::size_t kSeveralBodies = static_cast<std::size_t>(-1);

  std::size_t body = 0;  // b's place in the scene's list; 0 where two solids are asked
  double volume = 0;     // m^3
  Vec3 centroid;         // of the volume, world's frame, m
  // ∫ n dA over the part of a's surface inside b, world's axes, from a into b: its direction, and
  // its length in m^2, the area of the cut surface as seen along the normal. 0 if it cancels. Of
  // images and points it is that of their surface inside the tool, by the mean plane in each cell;
  // 0 where none is cut.
  Vec3 normal;
  double area = 0;
  // Greatest depth of a's surface below b's or of b's below a's, m: that at a corner of the meshes,
  // chosen by how deep the pieces of surface lie by which forces are summed. 0 without forces.
  // Below the surface of images and points: that of the tool's spheres.
  double depth = 0;
  // What it adds to force and torque of the whole, about the same point; 0 without forces.
  Wrench wrench;
  std::uint32_t patches = 1;  // that it sums; more than 1 only in the last

  friend constexpr bool operator==(const Contact&, const Contact&) = default;
};

// What a camera knows of the tool, or points without one, as fractions of its volume, wherever
// solids are. With the part in that body, all of volume_fraction without solids, they add up to 1.
struct Visibility {
  double seen_free = 0;    // before the surface that the camera sees; outside of what points show
  double unseen = 0;       // no part of the volume, but hidden by the surface, where nothing was
                           // measured (holes wider than four pixels), or where a scan is open
  double out_of_view = 0;  // outside of the image, or behind the camera; 0 of points

  friend constexpr bool operator==(const Visibility&, const Visibility&) = default;
};

// Bounds between which a true value lies 95 times of 100.
struct Interval {
  double low = 0, high = 0;

  friend constexpr bool operator==(const Interval&, const Interval&) = default;
};

struct Result {
  double volume = 0;           // m^3 of the tool inside the scene's solid
  double volume_fraction = 0;  // volume / volume of the tool
  Wrench wrench;
  std::uint32_t boundary = 0;  // spheres that the surface cuts
  std::uint32_t inside = 0;    // spheres behind the surface that count
  // Distinct points of the scene strictly inside a sphere of the tool, by the measure as printed.
  std::optional<std::uint32_t> points;
  // Of the scene's solids, if any: the largest Overlap::closure (vpm/solid.h), by which the
  // boundary of what the tool shares with one misses to be closed. At most 1e-8.
  std::optional<double> closure;
  // What the scene's camera knows, by the refined measure, with the volume in its own body; without
  // one, what its points know. Of solids alone all is seen. Of several such bodies nothing is told.
  std::optional<Visibility> visibility;
  // Of the volume, m^3, if QueryOptions::interval asks: for noise of the measured surface, what
  // cameras disagree by, and the tool's samples and planes; not for what was not seen, nor for
  // depths in steps far above the noise. Nothing is told of points as measured (Denoising::off).
  std::optional<Interval> volume_interval;

  friend constexpr bool operator==(const Result&, const Result&) = default;
};

// Says if a tool is in a scene's solid. Unknown: no as far as is known, but too little was seen.
enum class Collides : std::uint8_t { no, yes, unknown };

// Part of the tool that may be unseen or out of view where collides() answers no.
inline constexpr double kUnseenLimit = 0.02;

// Returns yes if a volume of the tool is in the solid; else no, if the answer tells that at most
// `unseen_limit` of it is unseen or out of view; else unknown, also for a NaN. Thread-safe.
constexpr Collides collides(const Result& result, double unseen_limit = kUnseenLimit) {
  if (result.volume > 0) return Collides::yes;
  if (!result.visibility) return Collides::unknown;
  const double not_seen = result.visibility->unseen + result.visibility->out_of_view;
  return not_seen <= unseen_limit ? Collides::no : Collides::unknown;
}

}  // namespace vpm
