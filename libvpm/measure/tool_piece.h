// Defines the parts of a cell: blocks, samples, and pieces as the measure adds them.
#pragma once

#include "libvpm/model/tool_model.h"

namespace vpm {

// Holds volume and centroid of a block's samples together, which the file does not store.
struct BlockMass {
  Vec3 centroid;      // about the tool's centre of mass
  double weight = 0;  // sum of the samples' weights, in parts of the tool's volume
};

struct CellView {
  const CellBlock* blocks = nullptr;
  const BlockMass* masses = nullptr;
  const CellSample* samples = nullptr;
  std::uint32_t begin = 0, end = 0;  // blocks of the cell
  Vec3 center;                       // the sphere's centre, about the tool's centre of mass, m
  double reach = 0;                  // bounding radius of the cell about `center`, m
};

// Describes a compact piece of a cell: a sample, or an uncut block or cell (radius 0).
struct ToolPiece {
  Vec3 at;  // centroid, about the tool's centre of mass, m
  double radius = 0, weight = 0;
  double extent = 0;                 // bounding radius about the centroid, nearly, m
  std::uint32_t begin = 0, end = 0;  // samples of a block or cell taken whole
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
