// Computes quotients and square roots (libvpm/core/division.h) on a device.
#pragma once

#include <vector>

namespace vpm::testing {

template <class Real>
struct Operands {
  Real a = 0, b = 0;
};
template <class Real>
struct Divided {
  Real quotient = 0;     // a / b
  Real square_root = 0;  // square root of |a|
  Real reciprocal = 0;   // 1 / b
};

// Returns the results for each pair of operands; Real is float or double.
template <class Real>
std::vector<Divided<Real>> divide_on_device(const std::vector<Operands<Real>>& operands);

}  // namespace vpm::testing
