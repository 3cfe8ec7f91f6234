// Nodes of a glTF file: their scene, their names, and which of them are shown.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace vpm {

// Lists all nodes in a scene where the file has none, since assimp reads only those of one; returns
// false where it has one, or no nodes that one could show.
bool give_scene(nlohmann::json& content);

// Calls the nodes that have no name by their places in the file: `node 0` is the first. Returns
// false if all have names.
bool name_nodes(nlohmann::json& content);

// Takes the meshes from the scene's nodes that KHR_node_visibility hides, which hides those below
// them, too. Returns the names of the nodes that lose one. Throws Error(refused), naming `file`, if
// no mesh is left, or if the node called `chosen`, or all that it holds, is hidden and no other of
// its name is shown.
std::vector<std::string> hide_nodes(nlohmann::json& content, const std::string& chosen,
                                    const std::string& file);

}  // namespace vpm
