// Measures by how much several cameras' images disagree about the surfaces that they all see:
// noise, and what is wrong with the cameras' poses.
#pragma once

#include <span>
#include <vector>

#include "libvpm/scene/rig/rig_surface.h"

namespace vpm {

struct RigAgreement {
  // For cameras i and j, at i * count + j, the distance, m, within which their readings may be of
  // one surface: four times the robust deviation of what both see clearly, and at least 2 mm, at
  // most 45 mm, at 1 m.
  std::vector<double> of_pairs;
  double most = 0;  // m, the greatest of these
  // Depth, m, by which something is well before a place: no camera that sees a surface of one piece
  // of the tool at less than a grazing angle has it so far before the piece.
  double well_before = 0;
};

RigAgreement agreement_of(std::span<const RigCamera> cameras);

}  // namespace vpm
