// Splits images into bands of rows for threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <vector>

namespace vpm {

// Rows per band: enough that the extra rows read above and below do not matter.
inline constexpr int kRowsPerBand = 32;
constexpr int bands_of(int height) {
  return (height + kRowsPerBand - 1) / kRowsPerBand;
}

// Calls body(begin, end) for each band of [0, height); bands begin at multiples of kRowsPerBand.
void for_bands(int height, const std::function<void(int begin, int end)>& body);

// Schedules a second pass over rows behind a first. A row of the second pass reads the first pass's
// rows up to `reach` above and below, so it runs as soon as these are made, while they are in the
// cache. Rows at a border of two bands run when the later band has made them.
class FollowingRows {
 public:
  static constexpr int kMostReach = kRowsPerBand / 2;

  // Starts another image; allocates nothing if the height is the same. Needs reach <= kMostReach.
  void start(int height, int reach);

  // Reports that the first pass has made row v; within a band, rows must be made in order. Calls
  // follow(begin, end) for the rows that can run now; each row runs once. Bands may be made by
  // several threads.
  template <class Follow>
  void made(int v, const Follow& follow) {
    const int band = v / kRowsPerBand, begin = band * kRowsPerBand,
              end = std::min(begin + kRowsPerBand, height_);
    const int first = begin == 0 ? 0 : begin + reach_;  // first row that reads this band only
    const int ready = v + 1 == height_ ? height_ : v + 1 - reach_;
    if (const int from = std::max(first, v - reach_); from < ready) follow(from, ready);
    if (begin > 0 && v + 1 == std::min(begin + 2 * reach_, end)) meet(band - 1, follow);
    if (end < height_ && v + 1 == end) meet(band, follow);
  }

 private:
  // Runs the rows at a border if both bands are made: the second caller finds that they are.
  template <class Follow>
  void meet(int band_above, const Follow& follow) {
    const int border = (band_above + 1) * kRowsPerBand;
    if (met_[static_cast<std::size_t>(band_above)].exchange(true))
      follow(border - reach_, std::min(border + reach_, height_));
  }

  int height_ = 0, reach_ = 0;
  std::vector<std::atomic<bool>> met_;  // one flag for each border of two bands
};

}  // namespace vpm
