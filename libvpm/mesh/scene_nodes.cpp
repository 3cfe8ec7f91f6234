#include "libvpm/mesh/scene_nodes.h"

#include <algorithm>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

constexpr std::size_t kNamesShown = 12;

}  // namespace

NodeChoice::NodeChoice(std::vector<SceneNode> nodes, const std::string& file)
    : file_(file), nodes_(std::move(nodes)), end_(nodes_.size()) {
  std::vector<bool> holds_faces(nodes_.size());  // itself, or a node below
  for (std::size_t k = nodes_.size(); k-- > 0;) {
    end_[k] = std::max(end_[k], k + 1);
    holds_faces[k] = holds_faces[k] || nodes_[k].has_faces;
    const std::size_t parent = nodes_[k].parent;
    end_[parent] = std::max(end_[parent], end_[k]);
    holds_faces[parent] = holds_faces[parent] || holds_faces[k];
  }
  for (std::size_t k = 0; k < nodes_.size(); ++k)
    if (holds_faces[k]) named_[nodes_[k].name].push_back(k);
}

std::vector<std::size_t> NodeChoice::choose(const std::string& name) const {
  const std::size_t top = name.empty() ? 0 : find(name);
  std::vector<std::size_t> chosen;
  for (std::size_t k = top; k < end_[top]; ++k)
    if (nodes_[k].has_faces) chosen.push_back(k);
  return chosen;
}

std::string NodeChoice::names_of(const std::vector<std::size_t>& nodes) const {
  std::string names;
  for (std::size_t k = 0; k < std::min(nodes.size(), kNamesShown); ++k)
    names += (k > 0 ? ", " : "") + label_of(nodes[k]);
  return names + (nodes.size() > kNamesShown ? ", …" : "");
}

std::string NodeChoice::joined(const std::vector<std::size_t>& nodes) const {
  return "the meshes of " + std::to_string(nodes.size()) + " nodes are joined: " + names_of(nodes) +
         "; `node` chooses one";
}

std::size_t NodeChoice::find(const std::string& name) const {
  const auto found = named_.find(name);
  if (found == named_.end()) return find_numbered(name);
  const std::vector<std::size_t>& same = found->second;
  if (same.back() < end_[same[0]]) return same[0];  // the others lie below it
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
  const std::vector<std::size_t>& same = named_.at(nodes_[k].name);
  const std::string name = file::shown(nodes_[k].name);
  if (same.size() == 1) return name;
  const auto place = std::lower_bound(same.begin(), same.end(), k) - same.begin();
  return name + "[" + std::to_string(place + 1) + "]";
}

}  // namespace vpm
