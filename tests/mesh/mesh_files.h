// Mesh files made for tests, and short ways to read them.
#pragma once

#include <string>

#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/solid.h"

namespace vpm::test {

std::string as_obj(const Solid& solid);
std::string as_off(const Solid& solid);
std::string as_ascii_ply(const Solid& solid);
std::string as_binary_ply(const Solid& solid, bool big_endian);  // in doubles
std::string as_ascii_stl(const Solid& solid);
std::string as_binary_stl(const Solid& solid);  // in floats

RawMesh parse(const std::string& content, const std::string& name);
CheckedSolid solid_of(const std::string& content, const std::string& name,
                      const SolidOptions& options = {});
CheckedSolid solid_of(const Solid& solid,
                      const SolidOptions& options = {});  // reads it through OFF

// Returns the message of the refusal, or "" if nothing was refused.
std::string refusal_of(const std::string& content, const std::string& name,
                       const SolidOptions& options = {});
std::string refusal_of(const Solid& solid);

inline bool contains(const std::string& message, const std::string& part) {
  return message.find(part) != std::string::npos;
}

// Returns both in one mesh.
Solid together(const Solid& a, const Solid& b);
Solid moved(Solid solid, Vec3 by);
Solid turned_over(Solid solid);

// Returns the path of a file of the shared data, or "" if the data is not there.
std::string shared_mesh(const std::string& name);

}  // namespace vpm::test
