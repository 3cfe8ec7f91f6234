#include "libvpm/mesh/scene_nodes.h"

#include <algorithm>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr std::size_t kNamesShown = 12;

std::string name_of(const aiNode& node) {
  return file::shown({node.mName.C_Str(), node.mName.length});
}

bool has_faces(const aiScene& scene, const aiNode& node) {
  for (unsigned k = 0; k < node.mNumMeshes; ++k)
    if (scene.mMeshes[node.mMeshes[k]]->mNumFaces > 0) return true;
  return false;
}

// Returns all nodes, each before those below it.
std::vector<PlacedNode> placed_nodes(const aiScene& scene, const aiMatrix4x4& of_root) {
  std::vector<PlacedNode> nodes;
  std::vector<PlacedNode> open{{scene.mRootNode, of_root, 0, 0, false}};
  while (!open.empty()) {
    const PlacedNode here = open.back();
    open.pop_back();
    const std::size_t at = nodes.size();
    nodes.push_back(here);
    nodes[at].end = at + 1;
    nodes[at].holds_faces = has_faces(scene, *here.node);
    for (unsigned k = here.node->mNumChildren; k-- > 0;) {
      const aiNode* const child = here.node->mChildren[k];
      open.push_back({child, here.to_world * child->mTransformation, at, 0, false});
    }
  }
  for (std::size_t k = nodes.size(); k-- > 1;) {
    PlacedNode& parent = nodes[nodes[k].parent];
    parent.end = std::max(parent.end, nodes[k].end);
    parent.holds_faces = parent.holds_faces || nodes[k].holds_faces;
  }
  return nodes;
}

}  // namespace

NodeChoice::NodeChoice(const aiScene& scene, const aiMatrix4x4& of_root, const std::string& file)
    : scene_(scene), file_(file), nodes_(placed_nodes(scene, of_root)) {
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    if (nodes_[k].holds_faces) named_[nodes_[k].node->mName.C_Str()].push_back(k);
}

std::vector<std::size_t> NodeChoice::choose(const std::string& name) const {
  const std::size_t top = name.empty() ? 0 : find(name);
  std::vector<std::size_t> chosen;
  for (std::size_t k = top; k < nodes_[top].end; ++k)
    if (has_faces(scene_, *nodes_[k].node)) chosen.push_back(k);
  return chosen;
}

PlacesByName NodeChoice::places() const {
  PlacesByName places;
  for (const PlacedNode& placed : nodes_)
    places[placed.node->mName.C_Str()].push_back(placed.to_world);
  return places;
}

std::string NodeChoice::names_of(const std::vector<std::size_t>& nodes) const {
  std::string names;
  for (std::size_t k = 0; k < std::min(nodes.size(), kNamesShown); ++k)
    names += (k > 0 ? ", " : "") + label_of(nodes[k]);
  return names + (nodes.size() > kNamesShown ? ", …" : "");
}

std::size_t NodeChoice::find(const std::string& name) const {
  const auto found = named_.find(name);
  if (found == named_.end()) return find_numbered(name);
  const std::vector<std::size_t>& same = found->second;
  if (same.back() < nodes_[same[0]].end) return same[0];  // the others lie below it
  refuse(std::to_string(same.size()) + " nodes have the name '" + file::shown(name) + "'", file_,
         "give `node` one of " + names_of(same) + ", or the name of a node above");
}

std::size_t NodeChoice::find_numbered(const std::string& name) const {
  const std::size_t bracket = name.rfind('[');
  const auto found = named_.find(name.substr(0, bracket));
  if (bracket != name.npos && name.ends_with(']') && found != named_.end()) {
    const auto number = file::to_count(name.substr(bracket + 1, name.size() - bracket - 2));
    if (number && *number >= 1 && *number <= found->second.size())
      return found->second[*number - 1];
  }
  refuse("it has no node '" + file::shown(name) + "'; nodes with faces: " + names_of(choose("")),
         file_);
}

std::string NodeChoice::label_of(std::size_t k) const {
  const std::vector<std::size_t>& same = named_.at(nodes_[k].node->mName.C_Str());
  const std::string name = name_of(*nodes_[k].node);
  if (same.size() == 1) return name;
  const auto place = std::lower_bound(same.begin(), same.end(), k) - same.begin();
  return name + "[" + std::to_string(place + 1) + "]";
}

}  // namespace vpm
