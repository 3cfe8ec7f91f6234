// What a share consists of.
#pragma once

#include "libvpm/model/tool_model.h"

namespace vpm {

// What a level knows of its blocks beyond the file: volume and centroid of the samples together.
struct BlockMass {
  Vec3 centroid;      // about the tool's centre of mass
  double weight = 0;  // sum of the samples' weights
};

struct CellView {
  const CellBlock* blocks = nullptr;
  const BlockMass* masses = nullptr;
  const CellSample* samples = nullptr;
  std::uint32_t begin = 0, end = 0;  // blocks of the cell
  Vec3 center;                       // of the sphere, about the tool's centre of mass
  double reach = 0;                  // of the share, from the sphere's centre
};

// A compact piece of a share: a sample, or what is not cut taken whole (radius 0): a block, or the
// share.
struct ToolPiece {
  Vec3 at;  // centroid, about the tool's centre of mass
  double radius = 0, weight = 0;
  double extent = 0;                 // how far it reaches from there, nearly
  std::uint32_t begin = 0, end = 0;  // its samples, of what is taken whole
};
VPM_HD inline ToolPiece piece_of(const CellSample& sample) {
  return {widen(sample.center), sample.radius, sample.weight, sample.radius, 0, 0};
}
VPM_HD inline ToolPiece piece_of(const BlockMass& mass, const CellBlock& block) {
  return {mass.centroid, 0, mass.weight, block.radius, block.begin, block.end};
}
VPM_HD inline ToolPiece piece_of(const BlockMass& mass, const CellView& cell) {
  ToolPiece piece{mass.centroid, 0, mass.weight, cell.reach, 0, 0};
  if (cell.begin < cell.end) {
    piece.begin = cell.blocks[cell.begin].begin;
    piece.end = cell.blocks[cell.end - 1].end;
  }
  return piece;
}

}  // namespace vpm
