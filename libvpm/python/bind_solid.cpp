// From a mesh to a tool: SolidMesh, SpherePacking, Tool.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <vpm/solid.h>

#include "libvpm/python/arrays.h"

namespace vpm::python {
namespace {

using Path = std::filesystem::path;

Repair repair_of(const std::string& text) {
  return choice<Repair>(text, "repair",
                        {{"none", Repair::none},
                         {"holes", Repair::holes},
                         {"voxel", Repair::voxel},
                         {"flood", Repair::flood}});
}

SolidOptions options_of(std::optional<double> scale, std::optional<double> weld,
                        const std::string& repair, int repair_voxels,
                        std::optional<double> max_hole, const std::string& node) {
  return {scale, weld, repair_of(repair), repair_voxels, max_hole, node};
}

// Says what was mended or may surprise, and hands the solid on.
SolidMesh shown(const SolidMesh& mesh) {
  Remarks remarks;
  for (const std::string& text : mesh.notes()) remarks.push_back({false, text});
  for (const std::string& text : mesh.warnings()) remarks.push_back({true, text});
  show(remarks);
  return mesh;
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const py::object& given) {
  const py::array faces = py::array::ensure(given);
  if (!faces || faces.ndim() != 2 || faces.shape(1) != 3)
    reject("`triangles` must have the shape (M, 3)", "split faces of more corners into triangles");
  if (faces.dtype().kind() != 'i' && faces.dtype().kind() != 'u')
    reject("`triangles` must be integers, indices of vertices");
  using Indices = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>;
  const Indices indices(faces);
  const std::int64_t* const n = indices.data();
  std::vector<std::array<std::uint32_t, 3>> triangles(static_cast<std::size_t>(faces.shape(0)));
  for (py::ssize_t k = 0; k < indices.size(); ++k) {
    if (n[k] < 0 || n[k] > std::int64_t{UINT32_MAX})
      reject("triangle " + std::to_string(k / 3) + " has the vertex " + std::to_string(n[k]),
             "indices count from 0");
    triangles[static_cast<std::size_t>(k / 3)][static_cast<std::size_t>(k % 3)] =
        static_cast<std::uint32_t>(n[k]);
  }
  return triangles;
}

// Returns what long work calls between its steps: Python's own progress, and whether the user has
// pressed Ctrl-C.
std::function<void(double)> progress_of(const py::object& progress) {
  return [&progress](double fraction) {
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(fraction);
  };
}

void bind_mesh(py::module_& module) {
  constexpr const char* kOptions =
      "scale: unit of the mesh, m (0.001 for millimetres); without it a mesh whose size few tools "
      "have is warned of.\nweld: vertices nearer than this, relative to the diagonal of the box, "
      "are joined.\nrepair: \"none\", \"holes\", \"voxel\" or \"flood\"; repair_voxels along the "
      "longest side; max_hole, m.\n\nWarnings are vpm.SetupWarning, notes go to the logger "
      "\"vpm\". Raises RefusedError, naming the defect, for what is no solid beyond the repair, "
      "ArgumentError for options out of range. Thread-safe.";
  py::class_<SolidMesh>(module, "SolidMesh",
                        "Closed mesh, oriented outward, in metres. Immutable and thread-safe.")
      .def_static(
          "read",
          [](const Path& path, std::optional<double> scale, std::optional<double> weld,
             const std::string& repair, int repair_voxels, std::optional<double> max_hole,
             const std::string& node) {
            const SolidOptions options =
                options_of(scale, weld, repair, repair_voxels, max_hole, node);
            const auto read = [&] {
              const py::gil_scoped_release unlocked;
              return SolidMesh::read(path.string(), options);
            };
            return shown(read());
          },
          py::arg("path"), py::kw_only(), py::arg("scale") = py::none(),
          py::arg("weld") = py::none(), py::arg("repair") = "none",
          py::arg("repair_voxels") = kRepairVoxels, py::arg("max_hole") = py::none(),
          py::arg("node") = "",
          (std::string("Reads an OBJ, OFF, PLY, STL, OM, COLLADA, glTF, 3MF or FBX file and makes "
                       "a solid of it.\n\nnode: name of the node of a scene that is read with "
                       "what is below it.\n") +
           kOptions)
              .c_str())
      .def_static(
          "from_triangles",
          [](const Numbers& vertices, const py::object& triangles, std::optional<double> scale,
             std::optional<double> weld, const std::string& repair, int repair_voxels,
             std::optional<double> max_hole) {
            const std::vector<Vec3> corners = vectors_of(vertices, "vertices");
            const auto faces = triangles_of(triangles);
            const SolidOptions options =
                options_of(scale, weld, repair, repair_voxels, max_hole, {});
            const auto make = [&] {
              const py::gil_scoped_release unlocked;
              return SolidMesh::from_triangles(corners, faces, options);
            };
            return shown(make());
          },
          py::arg("vertices"), py::arg("triangles"), py::kw_only(), py::arg("scale") = py::none(),
          py::arg("weld") = py::none(), py::arg("repair") = "none",
          py::arg("repair_voxels") = kRepairVoxels, py::arg("max_hole") = py::none(),
          (std::string("Makes a solid of triangles, counter-clockwise seen from "
                       "outside.\n\nvertices: (N, 3) numbers. triangles: (M, 3) integers, from "
                       "0.\n") +
           kOptions)
              .c_str())
      .def_property_readonly("volume", &SolidMesh::volume,
                             "Volume that is enclosed at least once, m^3.")
      .def_property_readonly("vertices", &SolidMesh::vertices, "Number of vertices.")
      .def_property_readonly("triangles", &SolidMesh::triangles, "Number of triangles.")
      .def_property_readonly("notes", &SolidMesh::notes, "What was mended, in sentences.")
      .def_property_readonly("warnings", &SolidMesh::warnings,
                             "What was accepted though it may surprise, in sentences.")
      .def("__repr__", [](const SolidMesh& mesh) {
        return py::str("<vpm.SolidMesh: {} triangles, {:.6g} m^3>")
            .format(mesh.triangles(), mesh.volume());
      });
}

void bind_packing(py::module_& module) {
  py::class_<SpherePacking>(module, "SpherePacking",
                            "Spheres that neither overlap nor leave the solid, largest first, with "
                            "the solid. Immutable and thread-safe.")
      .def_static(
          "read", [](const Path& path) { return SpherePacking::read(path.string()); },
          py::arg("path"), py::call_guard<py::gil_scoped_release>(),
          "Reads a .vpmp file. Raises RefusedError, naming the first defect.")
      .def(
          "write",
          [](const SpherePacking& packing, const Path& path) { packing.write(path.string()); },
          py::arg("path"), py::call_guard<py::gil_scoped_release>(),
          "Writes a .vpmp file, replacing it in one step. Raises WriteError.")
      .def_property_readonly(
          "spheres", [](const SpherePacking& packing) { return array_of(packing.spheres()); },
          "Array (N, 4) of x, y, z and radius in the mesh's frame, m.")
      .def("__repr__", [](const SpherePacking& packing) {
        return py::str("<vpm.SpherePacking: {} spheres>").format(packing.spheres().size());
      });
  module.def(
      "pack",
      [](const SolidMesh& solid, std::size_t spheres, double coverage, double min_radius,
         double max_radius, bool grow, const py::object& progress) {
        const PackingParameters parameters{spheres,    coverage, min_radius,
                                           max_radius, grow,     progress_of(progress)};
        const py::gil_scoped_release unlocked;
        return pack(solid, parameters);
      },
      py::arg("solid"), py::kw_only(), py::arg("spheres") = 1000, py::arg("coverage") = 1.0,
      py::arg("min_radius") = 0.0, py::arg("max_radius") = std::numeric_limits<double>::infinity(),
      py::arg("grow") = false, py::arg("progress") = py::none(),
      "Returns the packing of a solid with always the largest sphere that fits into what is left, "
      "certified: no overlap and no protrusion beyond 1e-9 of the longest side.\n\nspheres: as "
      "many are placed unless `coverage` (fraction of the volume) or `min_radius` (m) comes first. "
      "grow: all spheres grow together afterwards. progress: called with a fraction from 0 to 1; "
      "what it raises ends the work, as Ctrl-C does. Raises RefusedError if no sphere fits or the "
      "inside is unclear, ArgumentError for limits out of range. Thread-safe; the same spheres for "
      "any number of threads.");
}

void bind_tool(py::module_& module) {
  py::class_<ToolLevel>(module, "ToolLevel", "Level of detail of a tool.")
      .def_readonly("spheres", &ToolLevel::spheres, "Number of spheres, the largest ones.")
      .def_readonly("mean_error", &ToolLevel::mean_error,
                    "Mean error, fraction of the solid's volume; None if not calibrated.")
      .def_readonly("worst_error", &ToolLevel::worst_error,
                    "Largest error, fraction of the solid's volume; None if not calibrated.")
      .def("__repr__", [](const ToolLevel& level) {
        return py::str("<vpm.ToolLevel: {} spheres>").format(level.spheres);
      });
  py::class_<Tool>(module, "Tool",
                   "Solid packed with spheres, at several levels of detail, whose penetration is "
                   "measured. Frame: the mesh's own, m. Immutable and thread-safe.")
      .def_static(
          "read", [](const Path& path) { return Tool::read(path.string()); }, py::arg("path"),
          py::call_guard<py::gil_scoped_release>(),
          "Reads a .vpmg file. Raises RefusedError, naming the first defect.")
      .def(
          "write", [](const Tool& tool, const Path& path) { tool.write(path.string()); },
          py::arg("path"), py::call_guard<py::gil_scoped_release>(),
          "Writes a .vpmg file, replacing it in one step. Raises WriteError.")
      .def_property_readonly("volume", &Tool::volume, "Volume of the solid, m^3.")
      .def_property_readonly(
          "center_of_mass", [](const Tool& tool) { return array_of(tool.center_of_mass()); },
          "Array (3,): centre of mass of the homogeneous solid, about which torques are, m.")
      .def_property_readonly("radius", &Tool::radius,
                             "Largest distance of a point of the solid from the centre of mass, m.")
      .def_property_readonly("gyration", &Tool::gyration, "Radius of gyration, m.")
      .def_property_readonly(
          "spheres", [](const Tool& tool) { return array_of(tool.spheres()); },
          "Array (N, 4) of x, y, z and radius, m, largest first.")
      .def_property_readonly("levels", &Tool::levels,
                             "List of vpm.ToolLevel, coarsest first; at least one.")
      .def("__repr__", [](const Tool& tool) {
        return py::str("<vpm.Tool: {:.6g} m^3, radius {:.4g} m, {} spheres>")
            .format(tool.volume(), tool.radius(), tool.levels().back().spheres);
      });
  module.def(
      "build_tool",
      [](const SpherePacking& packing, const std::vector<std::uint32_t>& levels, double epsilon,
         bool calibrate, const py::object& progress) {
        const ToolParameters parameters{levels, epsilon, calibrate, progress_of(progress)};
        const py::gil_scoped_release unlocked;
        return build_tool(packing, parameters);
      },
      py::arg("packing"), py::kw_only(), py::arg("levels") = std::vector<std::uint32_t>(),
      py::arg("epsilon") = 0.0, py::arg("calibrate") = false, py::arg("progress") = py::none(),
      "Returns the tool of a packing: every point of the solid belongs to its nearest "
      "sphere.\n\nlevels: numbers of spheres of further levels; the whole packing always is one. "
      "epsilon: largest gap of an edge, m; 0: a tenth of a level's smallest radius. calibrate: "
      "measures each level's error against the solid. progress: as for pack(). Raises RefusedError "
      "for a packing that is none, ArgumentError for parameters out of range. Thread-safe.");
}

}  // namespace

void bind_solid(py::module_& module) {
  bind_mesh(module);
  bind_packing(module);
  bind_tool(module);
}

}  // namespace vpm::python
