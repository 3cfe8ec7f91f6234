#include "tools/query/spheres_out.h"

#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/view/sphere_files.h"

namespace vpm::tools {

void check_spheres_path(const std::string& path) {
  if (!view::sphere_format(path)) {
    throw Error(ErrorKind::invalid_argument,
                "--spheres-out " + path +
                    ": the name must end in .csv, .ply (balls), .points.ply or "
                    ".glb");
  }
}

void write_spheres(const std::string& path, std::span<const Sphere> spheres,
                   std::span<const SphereState> states, const Pose& pose) {
  std::vector<Sphere> placed;
  std::vector<std::uint8_t> numbers;
  for (std::size_t k = 0; k < spheres.size(); ++k) {
    placed.push_back({pose * spheres[k].center, spheres[k].radius});
    numbers.push_back(static_cast<std::uint8_t>(states[k]));
  }
  file::write_all(path, view::spheres_as(*view::sphere_format(path), placed, numbers));
}

}  // namespace vpm::tools
