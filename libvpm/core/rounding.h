// Tells how far coordinates were rounded when they were written, from their values.
#pragma once

#include <optional>
#include <span>

#include "libvpm/core/vec3.h"

namespace vpm {

struct Coarseness {
  double farthest = 0;      // the largest coordinate's distance from 0
  double step = 0;          // difference of neighbouring numbers there
  bool is_decimal = false;  // they have six digits, or else are floats of 32 bits

  // Returns "floats of 32 bits" or "numbers of six digits".
  const char* numbers() const;
};

// Returns the step between the numbers that the finite points were written with: floats of 32 bits,
// or six digits, which %g and C++ streams write unless they are told otherwise; the greater step of
// both. Returns nothing for other numbers, and for steps of at most `least`.
std::optional<Coarseness> coarseness_of(std::span<const Vec3> points, double least);

}  // namespace vpm
