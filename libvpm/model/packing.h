// Packing: non-overlapping spheres inside a solid, largest first, with that solid. Metres.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "libvpm/file/provenance.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"

namespace vpm {

// Every prefix of `spheres` is a packing too; levels of detail are prefixes.
struct Packing {
  std::vector<Sphere> spheres;
  Solid solid;
  // Tool, version, parameters, hash of the input; no clock time, so that equal runs give equal
  // files.
  file::Provenance provenance;
  // True if who made it knows that the solid neither meets nor encloses itself. Files do not tell.
  bool is_boundary = false;
};

// Reads a packing from a file, from standard input ("-"), or from bytes. Throws Error(refused) if
// it breaks a rule of formats/packing.md.
Packing read_packing(const std::string& path);
Packing parse_packing(std::vector<std::byte> bytes, const std::string& name);

// Writes a packing atomically, or to standard output ("-"). Throws Error(cannot_write).
void write_packing(const std::string& path, const Packing& packing);

}  // namespace vpm
