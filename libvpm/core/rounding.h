// Tells how far coordinates were rounded when they were written, from their values.
#pragma once

#include <optional>
#include <span>

#include "libvpm/core/vec3.h"

namespace vpm {

// Tells in which steps coordinates were written.
struct Coarseness {
  double farthest = 0;      // largest magnitude of a coordinate, in the unit of the points
  double step = 0;          // difference of neighbouring numbers at that magnitude, same unit
  bool is_decimal = false;  // the numbers have six digits; otherwise they are floats of 32 bits

  // Returns "floats of 32 bits" or "numbers of six digits".
  const char* numbers() const;
};

// Returns the step between the numbers that the finite points were written with: floats of 32 bits,
// or six digits, which %g and C++ streams write unless they are told otherwise; the greater step of
// both. Returns nothing for other numbers, and for steps of at most `least`.
std::optional<Coarseness> coarseness_of(std::span<const Vec3> points, double least);

}  // namespace vpm
