#include "libvpm/import/point_files.h"

#include <algorithm>
#include <iterator>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"

namespace vpm {
namespace {

// Names of a coordinate as PCL, Open3D and other programs write them.
struct ColumnNames {
  const char* name;
  const char* other;
};
constexpr std::array<ColumnNames, kPointColumns> kColumns{{{"x", "x"},
                                                           {"y", "y"},
                                                           {"z", "z"},
                                                           {"nx", "normal_x"},
                                                           {"ny", "normal_y"},
                                                           {"nz", "normal_z"}}};

std::string listed(std::span<const std::string> fields) {
  std::vector<std::string> names;
  std::copy_if(fields.begin(), fields.end(), std::back_inserter(names),
               [](const std::string& field) { return !field.empty(); });
  return file::listed(names);
}

}  // namespace

double& PointSet::at(std::size_t column, std::size_t point) {
  Vec3& vector = column < 3 ? positions[point] : normals[point];
  return column % 3 == 0 ? vector.x : column % 3 == 1 ? vector.y : vector.z;
}

PointColumns point_columns(std::span<const std::string> fields, const std::string& name) {
  PointColumns columns;
  for (std::size_t c = 0; c < kPointColumns; ++c) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (!file::is_word(fields[f], kColumns[c].name) &&
          !file::is_word(fields[f], kColumns[c].other))
        continue;
      if (columns[c])
        refuse("two fields hold " + std::string(kColumns[c].name) +
                   " of its points: " + fields[*columns[c]] + " and " + fields[f],
               name);
      columns[c] = f;
    }
    if (c < 3 && !columns[c])
      refuse("no field holds " + std::string(kColumns[c].name) + " of its points" +
                 (fields.empty() ? "" : "; its fields are " + listed(fields)),
             name);
  }
  if (!columns[3] || !columns[4] || !columns[5]) columns[3] = columns[4] = columns[5] = {};
  return columns;
}

}  // namespace vpm
