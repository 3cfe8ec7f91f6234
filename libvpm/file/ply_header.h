// Reads the header of PLY (Polygon File Format, Stanford): the elements of the file and the
// properties of each, which follow as text or as binary of either byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/core/vec3.h"
#include "libvpm/file/scalar_type.h"

namespace vpm::file {

struct PlyProperty {
  std::string name;
  ScalarType type;
  ScalarType length_type;  // type of a list's length; size 0 for a single value

  bool is_list() const { return length_type.size > 0; }
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyEncoding { text, little_endian, big_endian };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  Vec3 origin;  // place that the points are written about: "comment vpm origin X Y Z"; else 0
  std::size_t body = 0;   // offset of the first byte after the header
  std::size_t lines = 0;  // number of the header's last line
};

// True if the bytes begin as a PLY file does; a byte order mark must be removed before.
bool looks_like_ply(std::string_view bytes);

// Parses the header, whose keywords, types and names may be in letters of either case. Throws
// Error(refused), naming `name`, the line and the defect, also if the file is too small for what
// the header counts.
PlyHeader parse_ply_header(std::string_view bytes, const std::string& name);

// Returns the element of this name, which is given in lower case; null if there is none. Throws
// Error(refused), naming `name`, if there are several.
const PlyElement* find_element(const PlyHeader& header, std::string_view element,
                               const std::string& name);

}  // namespace vpm::file
