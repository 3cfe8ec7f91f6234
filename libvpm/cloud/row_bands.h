// Images are worked on in bands of rows, by threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <vector>

namespace vpm {

// Enough work to outweigh the rows above and below that a band reads as well.
inline constexpr int kRowsPerBand = 32;
constexpr int bands_of(int height) {
  return (height + kRowsPerBand - 1) / kRowsPerBand;
}

// Calls body(begin, end) for each band of [0, height), each beginning at a multiple of
// kRowsPerBand.
void for_bands(int height, const std::function<void(int begin, int end)>& body);

// Work on rows that reads what other work made of the rows up to some reach above and below: it
// follows that work row by row, while what it reads is in the cache. Rows between two bands follow
// when the later of these has made them.
class FollowingRows {
 public:
  static constexpr int kMostReach = kRowsPerBand / 2;

  // For another image; allocates nothing where it has as many rows. reach <= kMostReach
  void start(int height, int reach);

  // To be told of each row once it is made, within a band in their order: calls follow(begin, end)
  // for the rows that can follow now. Every row follows once. Bands may be made by several threads.
  template <class Follow>
  void made(int v, const Follow& follow) {
    const int band = v / kRowsPerBand, begin = band * kRowsPerBand,
              end = std::min(begin + kRowsPerBand, height_);
    const int first = begin == 0 ? 0 : begin + reach_;  // of those that read of this band only
    const int ready = v + 1 == height_ ? height_ : v + 1 - reach_;
    if (const int from = std::max(first, v - reach_); from < ready) follow(from, ready);
    if (begin > 0 && v + 1 == std::min(begin + 2 * reach_, end)) meet(band - 1, follow);
    if (end < height_ && v + 1 == end) meet(band, follow);
  }

 private:
  // The second one to come finds what both have made.
  template <class Follow>
  void meet(int band_above, const Follow& follow) {
    const int border = (band_above + 1) * kRowsPerBand;
    if (met_[static_cast<std::size_t>(band_above)].exchange(true))
      follow(border - reach_, std::min(border + reach_, height_));
  }

  int height_ = 0, reach_ = 0;
  std::vector<std::atomic<bool>> met_;  // below each band but the last
};

}  // namespace vpm
