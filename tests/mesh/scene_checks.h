// What the tests of scenes (glTF, COLLADA) ask of a mesh that is read.
#pragma once

#include <gtest/gtest.h>

#include <span>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/mesh/mesh_parsers.h"
#include "tests/mesh/mesh_files.h"

namespace vpm::test {

// True if this build reads scenes.
inline bool reads_scenes() {
  try {
    parse("{}", "a.gltf");
  } catch (const Error& fault) {
    return fault.kind() != ErrorKind::unavailable;
  }
  return true;
}

// Returns the mesh of a node, by its name.
inline RawMesh node_of(const std::string& content, const std::string& name) {
  return parse_mesh(std::as_bytes(std::span(content)), "a", name);
}

inline std::string all_notes(const RawMesh& mesh) {
  std::string text;
  for (const std::string& note : mesh.notes) text += note + "\n";
  return text;
}

inline void expect_note(const RawMesh& mesh, const std::string& note) {
  EXPECT_NE(all_notes(mesh).find(note), std::string::npos) << all_notes(mesh);
}

// Expects a refusal that names the file and has these words.
inline void expect_refusal(const std::string& content, const std::string& name,
                           const std::string& words) {
  const std::string refusal = refusal_of(content, name);
  EXPECT_NE(refusal.find(words), refusal.npos) << refusal;
  EXPECT_NE(refusal.find(name), refusal.npos) << refusal;
}

}  // namespace vpm::test
