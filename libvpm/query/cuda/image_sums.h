// What the warps of an image's query add up, and note of shares. For image_chunk.h.
#pragma once

#include "libvpm/query/cuda/shares.h"

namespace vpm::cuda {

// What a thread adds up of an image's query, and notes of shares.
class ImageSums {
 public:
  __device__ explicit ImageSums(const ShareNotes& notes) : notes_(notes) {}

  // What was found of the share of a unit.
  __device__ void note(const Unit& unit, const CellResult& result) {
    const bool cut = result.plane.count > 0;
    found_.sum.add(result.sum);
    if (cut || result.sum.volume.value != 0) count(unit, kCounted | (cut ? kCut : 0));
    if (cut) add_atomically(result.plane, notes_.planes[unit.share]);
  }
  __device__ void note_points(const Unit& unit) const {
    atomicOr(&notes_.words[unit.share], kCountsPoints);
  }
  __device__ RawResult found() {
    count_share(words_before_, bits_added_, found_);
    return found_;
  }

 private:
  // Others may note something of the share too, unless the unit is all of it. What its word was is
  // needed only when the next one comes, so that nobody waits for it.
  __device__ void count(const Unit& unit, std::uint32_t bits) {
    std::uint32_t& word = notes_.words[unit.share];
    if ((unit.flags & Unit::is_alone) != 0) {
      count_share(0, bits, found_);
      atomicOr(&word, bits);
      return;
    }
    count_share(words_before_, bits_added_, found_);
    words_before_ = atomicOr(&word, bits);
    bits_added_ = bits;
  }

  const ShareNotes& notes_;
  RawResult found_;
  std::uint32_t words_before_ = 0, bits_added_ = 0;  // of the share that was noted last
};

}  // namespace vpm::cuda
