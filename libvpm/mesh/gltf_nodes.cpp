#include "libvpm/mesh/gltf_nodes.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <utility>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/mesh/gltf_json.h"

namespace vpm {
namespace {

using nlohmann::json;

constexpr const char* kVisibility = "KHR_node_visibility";
constexpr const char* kShow = "show it in the program that wrote the file, and export it again";

bool hides(const json& node) {
  return member(member(member(node, "extensions"), kVisibility), "visible") == false;
}

// Returns the topmost nodes of the scene that is read: the one that the file names, or its first.
const json& top_nodes(const json& content) {
  const json& scenes = member(content, "scenes");
  const json& named = element(scenes, member(content, "scene"));
  const bool has_any = scenes.is_array() && !scenes.empty();
  return member(!named.is_null() || !has_any ? named : scenes.front(), "nodes");
}

// Tells of each node whether the scene shows it. A node that it reaches twice, which glTF forbids,
// is hidden if either way is.
struct Reached {
  std::set<std::uint64_t> shown, hidden;
};

Reached reached_nodes(const json& content) {
  const json& nodes = member(content, "nodes");
  Reached reached;
  std::vector<std::pair<json, bool>> open;  // index of a node, and whether one above is hidden
  for (const json& top : top_nodes(content)) open.emplace_back(top, false);
  while (!open.empty()) {
    const auto [index, is_below_hidden] = std::move(open.back());
    open.pop_back();
    const json& node = element(nodes, index);
    if (!node.is_object()) continue;
    const bool is_hidden = is_below_hidden || hides(node);
    auto& seen = is_hidden ? reached.hidden : reached.shown;
    if (!seen.insert(index.get<std::uint64_t>()).second) continue;
    for (const json& child : member(node, "children")) open.emplace_back(child, is_hidden);
  }
  for (const std::uint64_t index : reached.hidden) reached.shown.erase(index);
  return reached;
}

// Returns the indices of the nodes that are no other's children.
json roots_of(const json& content) {
  const json& nodes = member(content, "nodes");
  std::set<std::uint64_t> children;
  for (const json& node : nodes)
    for (const json& child : member(node, "children"))
      if (child.is_number_unsigned()) children.insert(child.get<std::uint64_t>());
  json roots = json::array();
  for (std::uint64_t k = 0; nodes.is_array() && k < nodes.size(); ++k)
    if (!children.contains(k)) roots.push_back(k);
  return roots;
}

}  // namespace

bool give_scene(json& content) {
  const json roots = roots_of(content);
  if (!member(content, "scenes").empty() || roots.empty()) return false;
  content["scene"] = 0;
  content["scenes"] = json::array({{{"nodes", roots}}});
  return true;
}

bool name_nodes(json& content) {
  if (!member(content, "nodes").is_array()) return false;
  bool names_any = false;
  std::size_t place = 0;
  for (json& node : content["nodes"]) {
    const std::size_t k = place++;
    if (!node.is_object() || !text_of(member(node, "name")).empty()) continue;
    node["name"] = "node " + std::to_string(k);
    names_any = true;
  }
  return names_any;
}

namespace {

// Returns the indices of the nodes of a name, and of all below them.
std::set<std::uint64_t> at_or_below(const json& nodes, const std::string& name) {
  std::vector<json> open;
  for (std::uint64_t k = 0; k < nodes.size(); ++k)
    if (text_of(member(nodes[k], "name")) == name) open.emplace_back(k);
  std::set<std::uint64_t> found;
  while (!open.empty()) {
    const json index = std::move(open.back());
    open.pop_back();
    const json& node = element(nodes, index);
    if (!node.is_object() || !found.insert(index.get<std::uint64_t>()).second) continue;
    for (const json& child : member(node, "children")) open.push_back(child);
  }
  return found;
}

constexpr const char* kHidden = " hidden (KHR_node_visibility)";

// Throws Error(refused) if the node called `chosen`, or all that it holds, is hidden, and no other
// of its name shows a mesh. `lost` has the nodes that were hidden with their meshes.
void check_chosen(const json& nodes, const std::string& chosen, const Reached& reached,
                  const std::set<std::uint64_t>& lost, const std::string& file) {
  bool is_hidden = false, is_shown = false, shows_mesh = false;
  std::vector<std::string> hidden;
  for (const std::uint64_t k : at_or_below(nodes, chosen)) {
    const std::string name = text_of(member(nodes[k], "name"));
    if (name == chosen) {
      is_hidden = is_hidden || reached.hidden.contains(k);
      is_shown = is_shown || reached.shown.contains(k);
    }
    if (lost.contains(k)) hidden.push_back(name);
    shows_mesh = shows_mesh || (reached.shown.contains(k) && !member(nodes[k], "mesh").is_null());
  }
  const std::string node = "its node '" + file::shown(chosen) + "'";
  if (is_hidden && !is_shown) refuse(node + " is" + kHidden, file, kShow);
  if (!hidden.empty() && !shows_mesh)
    refuse("all meshes of " + node + " are" + kHidden + ": " + file::listed(hidden), file, kShow);
}

}  // namespace

std::vector<std::string> hide_nodes(json& content, const std::string& chosen,
                                    const std::string& file) {
  const Reached reached = reached_nodes(content);
  const json& nodes = member(content, "nodes");
  std::set<std::uint64_t> lost;
  std::vector<std::string> names;
  for (const std::uint64_t k : reached.hidden) {
    if (content["nodes"][k].erase("mesh") == 0) continue;
    lost.insert(k);
    names.push_back(text_of(member(nodes[k], "name")));
  }
  if (!chosen.empty()) check_chosen(nodes, chosen, reached, lost, file);
  const bool keeps_mesh = std::ranges::any_of(
      reached.shown, [&](std::uint64_t k) { return !member(nodes[k], "mesh").is_null(); });
  if (!lost.empty() && !keeps_mesh)
    refuse(std::string("all of its meshes are") + kHidden + ": " + file::listed(names), file,
           kShow);
  return names;
}

}  // namespace vpm
