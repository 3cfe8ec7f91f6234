// The rest pose of a mesh with a skin, which says where its vertices are.
#pragma once

#include <assimp/scene.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace vpm {

// Transforms to the world of the nodes of each name.
using PlacesByName = std::map<std::string, std::vector<aiMatrix4x4>>;

struct PlacedVertices {
  std::vector<aiVector3D> vertices;
  bool is_mirrored = false;
};

PlacedVertices moved(const aiMesh& mesh, const aiMatrix4x4& move);

// Returns the mesh as its joints place it when the file is opened. Where all joints move the mesh
// the same way, as those of a model in the pose that it was made in, it is moved so as a whole: no
// rounding opens it. Returns nothing if a joint is missing or shares its name, or if a vertex
// belongs to none.
std::optional<PlacedVertices> rest_pose(const aiMesh& mesh, const PlacesByName& places);

}  // namespace vpm
