#include "libvpm/include/vpm/import.h"

#include "libvpm/api/handle_access.h"
#include "libvpm/file/stream.h"
#include "libvpm/import/import_cloud.h"

namespace vpm {

PointCloud import_cloud(const std::string& path, const ImportParameters& parameters) {
  ImportOptions options;
  options.intrinsics = parameters.intrinsics;
  options.depth.units_per_metre = parameters.units_per_metre;
  options.to_world = parameters.to_world;
  options.normals = parameters.normals;
  check_normal_options(options.normals);
  if (options.intrinsics) check_intrinsics(*options.intrinsics);
  const std::string name = path == "-" ? "standard input" : path;
  ImportedCloud imported = import_cloud(file::read_all(path), name, options);
  return HandleAccess::make<PointCloud>(std::move(imported.cloud));
}

}  // namespace vpm
