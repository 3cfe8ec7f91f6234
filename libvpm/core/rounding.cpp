#include "libvpm/core/rounding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vpm {
namespace {

// Returns the value of the sixth digit of a number that is not 0.
double sixth_digit(double number) {
  return std::pow(10.0, std::floor(std::log10(std::abs(number))) - 5);
}

bool has_six_digits(double number) {
  if (number == 0) return true;
  const double count = number / sixth_digit(number);
  return std::abs(count - std::round(count)) < 1e-6;
}

bool have_six_digits(const Vec3& p) {
  return has_six_digits(p.x) && has_six_digits(p.y) && has_six_digits(p.z);
}

}  // namespace

const char* Coarseness::numbers() const {
  return is_decimal ? "numbers of six digits" : "floats of 32 bits";
}

std::optional<Coarseness> coarseness_of(std::span<const Vec3> points, double least) {
  constexpr std::size_t kFewest = 64;  // points; a few may have round numbers
  Coarseness found;
  for (const Vec3& p : points)
    if (is_finite(p))
      found.farthest = std::max({found.farthest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  if (found.farthest == 0 || found.farthest > std::numeric_limits<float>::max())
    return std::nullopt;
  const auto last = static_cast<float>(found.farthest);
  const double float_step =
      double{std::nextafter(last, std::numeric_limits<float>::infinity())} - last;
  const double digit = sixth_digit(found.farthest);
  const auto all = [&](auto are_so) {
    return std::all_of(points.begin(), points.end(),
                       [&](const Vec3& p) { return !is_finite(p) || are_so(p); });
  };
  if (digit > least && points.size() >= kFewest && all(have_six_digits)) {
    found.step = digit;  // greater than a float's, of seven digits
    found.is_decimal = true;
    return found;
  }
  if (float_step > least && all([](const Vec3& p) { return widen(narrow(p)) == p; })) {
    found.step = float_step;
    return found;
  }
  return std::nullopt;
}

}  // namespace vpm
