#include "libvpm/model/packing.h"

#include "libvpm/core/box.h"
#include "libvpm/core/error.h"
#include "libvpm/core/lengths.h"
#include "libvpm/file/container.h"
#include "libvpm/model/sphere.h"

namespace vpm {
namespace {

constexpr file::ChunkId kPacked("SPHR"), kVertices("VERT"), kTriangles("TRIA");

static_assert(sizeof(Sphere) == 32 && sizeof(Vec3) == 24 && sizeof(Triangle) == 12,
              "chunks hold these types as they lie in memory");

void check_solid(const Solid& solid, const std::string& name) {
  if (solid.triangles.empty()) refuse("the solid has no triangles", name);
  for (std::size_t i = 0; i < solid.vertices.size(); ++i) {
    if (!is_in_range(solid.vertices[i]))
      refuse("vertex " + std::to_string(i) +
                 " of the solid is not finite, or further than 2^100 m from the origin",
             name);
  }
  for (std::size_t i = 0; i < solid.triangles.size(); ++i) {
    for (const std::uint32_t vertex : solid.triangles[i]) {
      if (vertex < solid.vertices.size()) continue;
      refuse("triangle " + std::to_string(i) + " of the solid names vertex " +
                 std::to_string(vertex) + ", but there are " +
                 std::to_string(solid.vertices.size()),
             name);
    }
  }
}

// Checks that spheres meet the solid's bounding box. It is a sanity check: proof that spheres are
// inside is the packer's task.
void check_within(const std::vector<Sphere>& spheres, const Solid& solid, const std::string& name) {
  Box box;
  for (const Vec3& vertex : solid.vertices) box.add(vertex);
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const auto& [c, r] = spheres[i];
    if (c.x < box.low.x - r || c.y < box.low.y - r || c.z < box.low.z - r || c.x > box.high.x + r ||
        c.y > box.high.y + r || c.z > box.high.z + r)
      refuse("sphere " + std::to_string(i) + " lies outside of the solid", name);
  }
}

void check(const Packing& packing, const std::string& name) {
  check_spheres(packing.spheres, name);
  check_solid(packing.solid, name);
  check_within(packing.spheres, packing.solid, name);
}

Packing packing_of(const file::Reader& reader) {
  Packing packing;
  packing.spheres = reader.read<Sphere>(kPacked, 0);
  packing.solid.vertices = reader.read<Vec3>(kVertices, 0);
  packing.solid.triangles = reader.read<Triangle>(kTriangles, 0);
  packing.provenance = reader.header().value("provenance", nlohmann::json());
  check(packing, reader.name());
  return packing;
}

}  // namespace

Packing read_packing(const std::string& path) {
  return packing_of(file::Reader(path, file::Kind::packing));
}

Packing parse_packing(std::vector<std::byte> bytes, const std::string& name) {
  return packing_of(file::Reader(std::move(bytes), name, file::Kind::packing));
}

void write_packing(const std::string& path, const Packing& packing) {
  check(packing, path);
  file::Writer writer(file::Kind::packing,
                      {{"unit", "m"}, {"provenance", packing.provenance.json()}});
  writer.add(kPacked, 0, std::span(packing.spheres));
  writer.add(kVertices, 0, std::span(packing.solid.vertices));
  writer.add(kTriangles, 0, std::span(packing.solid.triangles));
  writer.write(path);
}

}  // namespace vpm
