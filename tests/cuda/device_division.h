// Quotients and square roots (libvpm/core/division.h) on a device.
#pragma once

#include <vector>

namespace vpm::testing {

struct Operands {
  double a = 0, b = 0;
};
struct Divided {
  double quotient = 0;     // of a and b
  double square_root = 0;  // of |a|
};

std::vector<Divided> divide_on_device(const std::vector<Operands>& operands);

}  // namespace vpm::testing
