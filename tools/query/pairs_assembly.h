// What --pairs is given: a description of an assembly, or a folder of its parts
// (formats/assembly.md).
#pragma once

#include <vpm/pose.h>

#include <optional>
#include <string>
#include <vector>

#include "tools/common/program.h"

namespace vpm::tools {

// A part; lengths are in the assembly's unit.
struct AssemblyPart {
  std::string name, file;
  std::string node;  // of the file's scene; empty: all of it
  Pose pose;         // mesh to world
};

// Two names, in which * stands for any letters, and the volume that parts of these names may share,
// in the unit's cube; any if it is not set.
struct AllowedPair {
  std::string first, second;
  std::optional<double> volume;

  bool holds(const std::string& a, const std::string& b) const;
};

struct Assembly {
  std::string path;  // as it was given
  std::string unit;  // m, mm, ...; empty if the assembly does not say it
  std::vector<AssemblyPart> parts;
  std::vector<AllowedPair> allowed;
  double largest_deviation = 0;  // of a pose's rotation from a rotation

  // Returns the first rule that holds for two parts; null if none does.
  const AllowedPair* rule_for(const AssemblyPart& a, const AssemblyPart& b) const;
};

// Reads a description, of which "-" is standard input, or lists the meshes and models of a folder,
// ordered by name. Files of a description are beside it. Throws Error(refused), naming the place,
// for keys that are not known, values of another kind, names given twice or of no part, and fewer
// than two parts; Error(invalid_argument) for a path that is a mesh.
// Notes how many parts stand in folders of a folder, which are not read.
Assembly read_assembly(const Program& program, const std::string& path);

// Moves the parts whose names are the `id` of the poses in a file. Throws Error(refused), naming
// the line, for what is no pose, and for an `id` that is missing, given twice, or of no part.
void place_parts(Assembly& assembly, const std::string& poses);

}  // namespace vpm::tools
