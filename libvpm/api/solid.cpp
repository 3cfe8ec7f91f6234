#include <vpm/solid.h>
#include <vpm/version.h>

#include <nlohmann/json.hpp>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/graph/build_tool_model.h"
#include "libvpm/graph/calibration.h"
#include "libvpm/mesh/mesh_check.h"
#include "libvpm/mesh/mesh_reader.h"
#include "libvpm/model/packing.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/grow.h"
#include "libvpm/packing/packer.h"
#include "libvpm/solid/solid_surface.h"

namespace vpm {
namespace {

SolidMesh handle_of(const RawMesh& mesh, const SolidOptions& options) {
  return HandleAccess::make<SolidMesh>(make_solid(mesh, options));
}

// Says who made a file; the provenance of executables also has their options.
nlohmann::json made_by_library(const char* what) {
  return {{"tool", what}, {"version", VPM_VERSION}, {"parameters", nlohmann::json::object()}};
}

std::shared_ptr<const SolidSurface> surface_of(const CheckedSolid& checked, bool with_force) {
  const std::optional<Solid>& cut = checked.enclosure.surface;
  return std::make_shared<const SolidSurface>(cut ? *cut : checked.solid, with_force);
}

}  // namespace

SolidMesh SolidMesh::read(const std::string& path, const SolidOptions& options) {
  const std::string name = path == "-" ? "standard input" : path;
  return handle_of(parse_mesh(file::read_all(path), name, options.node), options);
}

SolidMesh SolidMesh::from_triangles(std::span<const Vec3> vertices,
                                    std::span<const std::array<std::uint32_t, 3>> triangles,
                                    const SolidOptions& options) {
  RawMesh mesh;
  mesh.name = "the triangles";
  mesh.vertices.assign(vertices.begin(), vertices.end());
  for (std::size_t k = 0; k < vertices.size(); ++k)
    if (!is_finite(vertices[k]))
      refuse("vertex " + std::to_string(k) + " is not finite", mesh.name);
  for (const auto& triangle : triangles) {
    for (const std::uint32_t vertex : triangle)
      if (vertex >= vertices.size())
        refuse("vertex index " + std::to_string(vertex) + " is out of range; there are " +
                   std::to_string(vertices.size()) + " vertices",
               mesh.name);
    mesh.add_triangle(triangle);
  }
  return handle_of(mesh, options);
}

double SolidMesh::volume() const {
  return HandleAccess::held(*this).facts.volume;
}
std::size_t SolidMesh::vertices() const {
  return HandleAccess::held(*this).solid.vertices.size();
}
std::size_t SolidMesh::triangles() const {
  return HandleAccess::held(*this).solid.triangles.size();
}
std::vector<std::string> SolidMesh::notes() const {
  return HandleAccess::held(*this).notes;
}
std::vector<std::string> SolidMesh::warnings() const {
  return HandleAccess::held(*this).warnings;
}

SolidBody::SolidBody(const SolidMesh& mesh, bool with_force)
    : surface_(surface_of(HandleAccess::held(mesh), with_force)) {}

SpherePacking SpherePacking::read(const std::string& path) {
  return HandleAccess::make<SpherePacking>(read_packing(path));
}

void SpherePacking::write(const std::string& path) const {
  write_packing(path, HandleAccess::held(*this));
}

std::vector<Sphere> SpherePacking::spheres() const {
  return HandleAccess::held(*this).spheres;
}

SpherePacking pack(const SolidMesh& solid, const PackingParameters& parameters) {
  const CheckedSolid& checked = HandleAccess::held(solid);
  PackOptions options;
  options.spheres = parameters.spheres;
  options.coverage = parameters.coverage;
  options.min_radius = parameters.min_radius;
  options.max_radius = parameters.max_radius;
  options.enclosure = &checked.enclosure;
  options.progress = parameters.progress;
  PackResult result = pack(checked.solid, options);
  if (result.spheres.empty())
    refuse("no sphere fits into the solid", {}, "give a smaller `min_radius`");
  if (parameters.grow) {
    GrowOptions growing;
    growing.enclosure = &checked.enclosure;
    growing.min_radius = parameters.min_radius;
    growing.max_radius = parameters.max_radius;
    growing.progress = parameters.progress;
    result.spheres = grow(checked.solid, result.spheres, growing);
  }
  double volume_of_spheres = 0;
  for (const Sphere& sphere : result.spheres) volume_of_spheres += volume(sphere);
  refuse_uncertified("the solid", volume_of_spheres / checked.facts.volume,
                     certify(checked.solid, result.spheres, &checked.enclosure));
  Packing packing{std::move(result.spheres), checked.solid, made_by_library("vpm::pack")};
  packing.provenance.json()["solid_hash"] = content_hash(packing.solid);
  packing.is_boundary =
      !checked.enclosure.surface && checked.enclosure.faces_tell && checked.facts.inner_shells == 0;
  return HandleAccess::make<SpherePacking>(std::move(packing));
}

Tool build_tool(const SpherePacking& spheres, const ToolParameters& parameters) {
  const Packing& packing = HandleAccess::held(spheres);
  GraphOptions options;
  options.epsilon = parameters.epsilon;
  options.levels = parameters.levels;
  options.progress = parameters.progress;
  ToolModel model = build_tool_model(packing, options);
  if (parameters.calibrate) model.calibration = calibrate(model, packing.solid);
  model.provenance = made_by_library("vpm::build_tool");
  model.provenance.json()["packing"] = packing.provenance.json();
  return HandleAccess::make<Tool>(std::move(model));
}

}  // namespace vpm
