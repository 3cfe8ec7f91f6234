// Sums and notes the results of an image's query, for image_task_group.h.
#pragma once

#include "libvpm/backend/cuda/cell_notes.h"

namespace vpm::cuda {

// Holds the result of a block task.
struct TaskSums {
  ToolSum sum;
  bool is_cut = false;
};

// Sums of one thread in an image's query, and its notes about cells.
class ImageSums {
 public:
  __device__ explicit ImageSums(const CellNotes& notes) : notes_(notes) {}

  // Notes the result of a task's cell, once per thread; others may note the same cell.
  __device__ void note(const BlockTask& task, const TaskSums& found) {
    found_.sum.add(found.sum);
    if (!found.is_cut && found.sum.volume.value == 0) return;
    bits_added_ = cell_bit::counted | (found.is_cut ? cell_bit::cut : 0);
    word_before_ = atomicOr(&notes_.words[task.cell], bits_added_);
  }
  // Notes the plane of a cut cell.
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
  std::uint32_t word_before_ = 0, bits_added_ = 0;  // word of the noted cell
};

}  // namespace vpm::cuda
