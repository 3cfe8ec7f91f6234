#include "libvpm/mesh/scene_skin.h"

#include <algorithm>
#include <cmath>

namespace vpm {
namespace {

// True if the transforms differ by no more than rounding does, relative to their largest entry.
bool are_same(const aiMatrix4x4& a, const aiMatrix4x4& b) {
  constexpr float kRounding = 1e-5F;
  float largest = 0, apart = 0;
  for (unsigned row = 0; row < 3; ++row) {
    for (unsigned column = 0; column < 4; ++column) {
      if (!std::isfinite(a[row][column]) || !std::isfinite(b[row][column])) return false;
      largest = std::max(largest, std::abs(a[row][column]));
      apart = std::max(apart, std::abs(a[row][column] - b[row][column]));
    }
  }
  return apart <= kRounding * largest;
}

// Returns what each joint does to the mesh.
std::optional<std::vector<aiMatrix4x4>> moves_of(const aiMesh& mesh, const PlacesByName& places) {
  std::vector<aiMatrix4x4> moves;
  for (unsigned k = 0; k < mesh.mNumBones; ++k) {
    const auto place = places.find(mesh.mBones[k]->mName.C_Str());
    if (place == places.end() || place->second.size() != 1) return std::nullopt;
    moves.push_back(place->second[0] * mesh.mBones[k]->mOffsetMatrix);
  }
  return moves;
}

}  // namespace

PlacedVertices moved(const aiMesh& mesh, const aiMatrix4x4& move) {
  PlacedVertices placed;
  placed.is_mirrored = move.Determinant() < 0;
  for (unsigned k = 0; k < mesh.mNumVertices; ++k)
    placed.vertices.push_back(move * mesh.mVertices[k]);
  return placed;
}

std::optional<PlacedVertices> rest_pose(const aiMesh& mesh, const PlacesByName& places) {
  const auto moves = moves_of(mesh, places);
  if (!moves || moves->empty()) return std::nullopt;
  const aiMatrix4x4& first = moves->front();
  if (std::all_of(moves->begin(), moves->end(),
                  [&](const aiMatrix4x4& move) { return are_same(first, move); }))
    return moved(mesh, are_same(first, aiMatrix4x4()) ? aiMatrix4x4() : first);
  PlacedVertices pose;
  pose.is_mirrored = first.Determinant() < 0;
  pose.vertices.resize(mesh.mNumVertices);
  std::vector<float> total(mesh.mNumVertices, 0.0F);
  for (unsigned j = 0; j < mesh.mNumBones; ++j) {
    const aiBone& bone = *mesh.mBones[j];
    for (unsigned k = 0; k < bone.mNumWeights; ++k) {
      const auto [vertex, weight] = bone.mWeights[k];
      if (vertex >= mesh.mNumVertices) return std::nullopt;
      pose.vertices[vertex] += weight * ((*moves)[j] * mesh.mVertices[vertex]);
      total[vertex] += weight;
    }
  }
  for (unsigned k = 0; k < mesh.mNumVertices; ++k) {
    if (!(total[k] > 0)) return std::nullopt;
    pose.vertices[k] /= total[k];
  }
  return pose;
}

}  // namespace vpm
