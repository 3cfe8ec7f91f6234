// Nodes of a scene, of which some are read.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace vpm {

struct SceneNode {
  std::string name;
  std::size_t parent;  // index of the node above, its own for the root
  bool has_faces;      // itself, not a node below
};

// Chooses among the nodes that hold faces. Where several have one name, they are called NAME[1],
// NAME[2], ... in the order of the file. Keeps a reference to `file`, its name.
class NodeChoice {
 public:
  // Takes the root and then the others, each before those below it and these before the next one.
  NodeChoice(std::vector<SceneNode> nodes, const std::string& file);

  // Returns those with faces of their own: all, or that of the given name and those below it.
  // Throws Error(refused) if no node has the name, or several that do not lie below each other.
  std::vector<std::size_t> choose(const std::string& name) const;

  // Returns the names by which they are chosen.
  std::string names_of(const std::vector<std::size_t>& nodes) const;
  // Returns the note that several nodes make one mesh.
  std::string joined(const std::vector<std::size_t>& nodes) const;

 private:
  std::size_t find(const std::string& name) const;
  std::size_t find_numbered(const std::string& name) const;
  std::string label_of(std::size_t k) const;

  const std::string& file_;
  std::vector<SceneNode> nodes_;
  std::vector<std::size_t> end_;                           // one after the last node below each
  std::map<std::string, std::vector<std::size_t>> named_;  // those that hold faces, in order
};

}  // namespace vpm
