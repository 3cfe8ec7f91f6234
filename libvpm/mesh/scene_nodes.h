// Nodes of a scene, of which some are read.
#pragma once

#include <assimp/scene.h>

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "libvpm/mesh/scene_skin.h"

namespace vpm {

struct PlacedNode {
  const aiNode* node;
  aiMatrix4x4 to_world;
  std::size_t parent, end;  // index of the parent, its own for the root; one after the last below
  bool holds_faces;         // itself, or a node below
};

// Chooses among the nodes that hold faces. Where several have one name, they are called NAME[1],
// NAME[2], ... in the order of the file. Keeps references to the scene and to `file`, its name.
class NodeChoice {
 public:
  NodeChoice(const aiScene& scene, const aiMatrix4x4& of_root, const std::string& file);

  // Returns those with faces of their own: all, or that of the given name and those below it.
  // Throws Error(refused) if no node has the name, or several that do not lie below each other.
  std::vector<std::size_t> choose(const std::string& name) const;

  const PlacedNode& operator[](std::size_t k) const { return nodes_[k]; }

  PlacesByName places() const;

  // Returns the names by which they are chosen.
  std::string names_of(const std::vector<std::size_t>& nodes) const;

 private:
  std::size_t find(const std::string& name) const;
  std::size_t find_numbered(const std::string& name) const;
  std::string label_of(std::size_t k) const;

  const aiScene& scene_;
  const std::string& file_;
  std::vector<PlacedNode> nodes_;
  std::map<std::string, std::vector<std::size_t>> named_;  // those that hold faces, in order
};

}  // namespace vpm
