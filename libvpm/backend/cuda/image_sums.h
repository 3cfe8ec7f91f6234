// What the warps of an image's query add up, and note of shares. For image_chunk.h.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

// What is found of a unit.
struct TaskSums {
  ToolSum sum;
  bool is_cut = false;
};

// What a thread adds up of an image's query, and notes of shares.
class ImageSums {
 public:
  __device__ explicit ImageSums(const CellNotes& notes) : notes_(notes) {}

  // What was found of the share of a unit, of one unit at most; others may note something of the
  // share too.
  __device__ void note(const BlockTask& task, const TaskSums& found) {
    found_.sum.add(found.sum);
    if (!found.is_cut && found.sum.volume.value == 0) return;
    bits_added_ = cell_bit::counted | (found.is_cut ? cell_bit::cut : 0);
    word_before_ = atomicOr(&notes_.words[task.cell], bits_added_);
  }
  // The planes of cut shares.
  __device__ void note(const BlockTask& task, const ContactPlane& found) const {
    if (found.count > 0) add_atomically(found, notes_.planes[task.cell]);
  }
  __device__ void note_points(const BlockTask& task) const {
    atomicOr(&notes_.words[task.cell], cell_bit::counts_points);
  }
  __device__ RawResult found() {
    count_cell(word_before_, bits_added_, found_);
    return found_;
  }

 private:
  const CellNotes& notes_;
  RawResult found_;
  std::uint32_t word_before_ = 0, bits_added_ = 0;  // of the share that was noted
};

}  // namespace vpm::cuda
