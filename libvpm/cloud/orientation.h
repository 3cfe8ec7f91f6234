// Finds normals of points that contradict those about them, and turns normals so that they agree.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"

namespace vpm {

// How normals are to be turned: towards the sensor at a place in world coordinates, or, without
// one, consistently.
struct Orientation {
  std::optional<Vec3> sensor;
};
// Parses "neighbours", or the place as "x,y,z". Another text throws Error(invalid_argument).
Orientation orientation_from_text(const std::string& text);

// Turns normals of a cloud by one of the functions below. Returns how many were turned.
std::size_t orient(const Orientation& orientation, Cloud& cloud);

// Returns the indices, ascending, of points whose normals are opposite to those of more than a
// third of the nearest points on the same surface: single ones, and those at the border of a part
// that is turned as a whole.
std::vector<std::uint32_t> contradicting_normals(const Cloud& cloud);

// Turns the normals that face away from a place in world coordinates, that of the sensor. Returns
// how many.
std::size_t orient_towards(Vec3 sensor, Cloud& cloud);

// Turns normals so that neighbours agree (propagation over nearest neighbours, as Hoppe, DeRose,
// Duchamp, McDonald, Stuetzle 1992, "Surface reconstruction from unorganized points", and across
// edges by votes of all points there) and each surface faces out of what it encloses, or into it
// where others enclose it, as the wall of a hollow does. Of a surface that is flat as a whole,
// whose sides nothing tells apart, fewer than half are turned. Returns how many were turned.
std::size_t orient_consistently(Cloud& cloud);

}  // namespace vpm
