#include "libvpm/cloud/row_bands.h"

#include "libvpm/core/parallel.h"

namespace vpm {

void for_bands(int height, const std::function<void(int begin, int end)>& body) {
  parallel_for(static_cast<std::size_t>(bands_of(height)), 1,
               [&](std::size_t first, std::size_t last) {
                 for (int band = static_cast<int>(first); band < static_cast<int>(last); ++band) {
                   const int begin = band * kRowsPerBand;
                   body(begin, std::min(begin + kRowsPerBand, height));
                 }
               });
}

void FollowingRows::start(int height, int reach) {
  height_ = height;
  reach_ = reach;
  const auto borders = static_cast<std::size_t>(std::max(bands_of(height) - 1, 0));
  if (met_.size() != borders) met_ = std::vector<std::atomic<bool>>(borders);
  for (std::atomic<bool>& met : met_) met = false;
}

}  // namespace vpm
