#include <span>

#include "libvpm/file/checksum.h"
#include "libvpm/model/solid.h"

namespace vpm {

std::string content_hash(const Solid& solid) {
  const std::array<std::uint64_t, 2> counts{solid.vertices.size(), solid.triangles.size()};
  return file::content_hash({std::as_bytes(std::span(counts)),
                             std::as_bytes(std::span(solid.vertices)),
                             std::as_bytes(std::span(solid.triangles))});
}

}  // namespace vpm
