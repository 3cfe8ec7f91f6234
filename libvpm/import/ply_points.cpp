#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/ply_body.h"
#include "libvpm/file/ply_header.h"
#include "libvpm/file/text.h"
#include "libvpm/import/point_files.h"

namespace vpm {
namespace {

using file::PlyBody;
using file::PlyElement;
using file::PlyHeader;
using file::PlyProperty;

constexpr int kUnused = -1;

// Returns for each property of the vertices the column of PointSet::at that it fills.
std::vector<int> columns_of(const PlyElement& vertices, const std::string& name) {
  std::vector<std::string> fields;
  for (const PlyProperty& property : vertices.properties)
    fields.push_back(property.is_list() ? std::string() : property.name);
  std::vector<int> columns(fields.size(), kUnused);
  const PointColumns found = point_columns(fields, name);
  for (std::size_t c = 0; c < kPointColumns; ++c)
    if (found[c]) columns[*found[c]] = static_cast<int>(c);
  return columns;
}

const PlyElement& vertices_of(const PlyHeader& header, const std::string& name) {
  const PlyElement* const vertices = file::find_element(header, "vertex", name);
  if (vertices == nullptr) refuse("the header has no element 'vertex'", name);
  if (vertices->count == 0) refuse("it holds no points", name);
  if (vertices->count > kMaxPoints) {
    refuse("the header promises " + std::to_string(vertices->count) + " vertices; at most " +
               std::to_string(kMaxPoints) + " are read",
           name);
  }
  return *vertices;
}

}  // namespace

PointSet parse_ply_points(std::span<const std::byte> bytes, const std::string& name) {
  const std::string_view text = file::without_byte_order_mark(file::as_text(bytes));
  const PlyHeader header = file::parse_ply_header(text, name);
  const PlyElement& vertices = vertices_of(header, name);
  const std::vector<int> columns = columns_of(vertices, name);
  PointSet points;
  points.width = static_cast<std::uint32_t>(vertices.count);
  points.positions.resize(vertices.count);
  if (std::ranges::count(columns, 3) > 0) points.normals.resize(vertices.count);

  PlyBody body(text, header, name);
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t row = 0; row < element.count; ++row) {
      body.begin_record();
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const PlyProperty& property = element.properties[k];
        if (&element == &vertices && columns[k] != kUnused) {
          points.at(static_cast<std::size_t>(columns[k]), row) = body.value(property.type);
        } else {
          body.skip(property);
        }
      }
      body.end_record();
    }
  }
  for (Vec3& p : points.positions) p = p + header.origin;
  for (std::string& note : body.unread()) points.remarks.push_back({true, std::move(note)});
  return points;
}

}  // namespace vpm
