#include "libvpm/solid/depth_grid.h"

#include <algorithm>
#include <cmath>

#include "libvpm/core/box.h"

namespace vpm {
namespace {

// Depth outside is known up to so many cells; farther places are only known to be outside.
constexpr double kBandOutside = 3;

}  // namespace

DepthGrid::DepthGrid(Vec3 low, Vec3 high, int cells, const Inside& inside,
                     const Distance& distance) {
  const Vec3 size = high - low;
  cell_ = std::max({size.x, size.y, size.z}) / cells;
  per_cell_ = 1 / cell_;
  low_ = low - 0.5 * cell_ * Vec3{1, 1, 1};
  for (std::size_t k = 0; k < 3; ++k)
    count_[k] = static_cast<std::size_t>(coordinate(high - low_, static_cast<int>(k)) / cell_) + 3;
  std::vector<float> depths;
  depths.reserve(count_[0] * count_[1] * count_[2]);
  for (std::size_t z = 0; z < count_[2]; ++z)
    for (std::size_t y = 0; y < count_[1]; ++y) {
      // The distance at a place bounds the next one's, which shortens the search.
      double bound = HUGE_VAL;
      for (std::size_t x = 0; x < count_[0]; ++x) {
        const Vec3 place = low_ + cell_ * Vec3{static_cast<double>(x), static_cast<double>(y),
                                               static_cast<double>(z)};
        const bool in = inside(place);
        const double band = in ? HUGE_VAL : kBandOutside * cell_, within = std::min(bound, band);
        const double found = std::min(distance(place, within), within);
        bound = found < band ? found + 1.01 * cell_ : HUGE_VAL;
        depths.push_back(static_cast<float>(in ? found : -found));
      }
    }
  constexpr double kMost = (1 << 8 * kBytes) - 1;
  const auto [least, greatest] = std::ranges::minmax(depths);
  least_ = least, step_ = std::max(double{greatest} - least, cell_) / kMost;
  samples_.reserve(kBytes * depths.size());
  for (const double depth : depths) {
    const auto sample = static_cast<std::uint32_t>(std::lround((depth - least_) / step_));
    for (std::size_t byte = 0; byte < kBytes; ++byte)
      samples_.push_back(static_cast<std::uint8_t>(sample >> 8 * byte));
  }
}

Depth DepthGrid::at(Vec3 x) const {
  const Vec3 place = per_cell_ * (x - low_);
  const std::array<double, 3> along_axes{place.x, place.y, place.z};
  std::array<std::size_t, 3> cell{};
  std::array<double, 3> part{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto last = static_cast<std::int64_t>(count_[k]) - 1;
    const double inside = std::clamp(along_axes[k], 0.0, static_cast<double>(last));
    const std::int64_t at = std::min(static_cast<std::int64_t>(inside), last - 1);
    cell[k] = static_cast<std::size_t>(at);
    part[k] = inside - static_cast<double>(at);
  }
  const std::size_t y = count_[0], z = count_[0] * count_[1];
  const std::size_t first = cell[0] + y * cell[1] + z * cell[2];
  const auto between = [](double from, double to, double t) { return from + t * (to - from); };
  const auto [tx, ty, tz] = part;
  // Along x, in whole numbers of steps.
  const auto more = [&](std::size_t k) {
    return static_cast<double>(sample(first + k + 1) - sample(first + k));
  };
  const auto along = [&](std::size_t k) { return sample(first + k) + tx * more(k); };
  const double x00 = along(0), x10 = along(y), x01 = along(z), x11 = along(y + z);
  const double y0 = between(x00, x10, ty), y1 = between(x01, x11, ty);
  const double along_x0 = between(more(0), more(y), ty),
               along_x1 = between(more(z), more(y + z), ty);
  const Vec3 gradient{between(along_x0, along_x1, tz), between(x10 - x00, x11 - x01, tz), y1 - y0};
  return {least_ + step_ * between(y0, y1, tz), per_cell_ * step_ * gradient};
}

}  // namespace vpm
