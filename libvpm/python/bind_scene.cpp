// What tools are measured against: PointCloud, Body, Scene, DepthStream.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <vpm/depth_stream.h>
#include <vpm/import.h>
#include <vpm/scene.h>
#include <vpm/solid.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/python/arrays.h"

namespace vpm::python {
namespace {

using Path = std::filesystem::path;

NormalOptions normals_of(const std::string& method, int window, double edge_gate) {
  return {method_of(method), window, edge_gate};
}

// Returns the parameters of an import; vpm/__init__.py names and gives them.
ImportParameters parameters_of(const py::kwargs& given) {
  const auto of = [&]<class Value>(const char* name, Value fallback) {
    return given.contains(name) ? given[name].cast<Value>() : fallback;
  };
  ImportParameters made;
  if (const auto k = of("intrinsics", py::object(py::none())); !k.is_none())
    made.intrinsics = intrinsics_of(Numbers(k));
  if (const auto pose = of("camera_pose", py::object(py::none())); !pose.is_none())
    made.camera_pose = pose_of(Numbers(pose));
  made.axes = axes_of(of("axes", std::string("opencv")));
  made.depth_scale = of("depth_scale", made.depth_scale);
  made.decode = of("decode", made.decode);
  made.invalid = of("invalid", made.invalid);
  made.usual_invalid = of("usual_invalid", made.usual_invalid);
  if (const auto range = of("range", std::optional<std::pair<double, double>>()))
    made.range = {range->first, range->second};
  made.along_ray = of("along_ray", made.along_ray);
  made.channel = of("channel", made.channel);
  made.flip = of("flip", made.flip);
  made.orient = of("orient", made.orient);
  made.normals =
      normals_of(of("method", std::string("inverse-depth")), of("window", made.normals.window),
                 of("edge_gate", made.normals.edge_gate));
  return made;
}

// The arguments of a depth image, in memory or in a file,
constexpr const char* kImageArguments =
    "intrinsics: fx, fy, cx, cy in pixels, or a matrix (3, 3); needed for depth images.\n"
    "camera_pose: pose of the camera, or of the points' frame, in the world.\n"
    "axes: \"opencv\" (x right, y down, z forward), \"opengl\" or \"ros\".\n"
    "depth_scale: units per metre; 1000 for integers and 1 for floats unless given.\n"
    "decode: \"swapped\", \"big-endian\", \"rotated\", \"disparity\", or several with commas.\n"
    "invalid: values that mean \"not measured\"; usual_invalid: 0, 65535 and the like do too.\n"
    "range: (nearest, farthest), m; other depths count as not measured.\n"
    "along_ray: values are distances along the ray.\n"
    "method, window, edge_gate: how normals are estimated (\"inverse-depth\" or \"pca\").\n";
// those of a file alone,
constexpr const char* kFileArguments =
    "channel: of an OpenEXR image.\n"
    "flip: turns the normals of points without camera. orient: turns those that face away from a "
    "place, \"x,y,z\", or with \"neighbours\" those that disagree with others.\n";
// and what both do beside.
constexpr const char* kImportSays =
    "\nWarnings are vpm.SetupWarning, notes go to the logger \"vpm\". Raises RefusedError, naming "
    "the defect, and ArgumentError for arguments out of range. Thread-safe.";

template <class Value>
using Image = py::array_t<Value, py::array::c_style | py::array::forcecast>;

// Imports the pixels of an array of 16-bit counts or floats.
template <class Value>
PointCloud import_pixels(const py::array& image, const ImportParameters& parameters,
                         Remarks& remarks) {
  const Image<Value> pixels(image);
  const auto height = static_cast<std::uint32_t>(image.shape(0)),
             width = static_cast<std::uint32_t>(image.shape(1));
  const std::span<const Value> values(pixels.data(), static_cast<std::size_t>(pixels.size()));
  const py::gil_scoped_release unlocked;
  return import_depth(values, width, height, parameters, &remarks);
}

PointCloud import_image(const py::array& image, const ImportParameters& parameters) {
  if (image.ndim() != 2) reject("a depth image is an array of shape (height, width)");
  Remarks remarks;
  const bool are_counts = image.dtype().kind() == 'u' && image.itemsize() == 2;
  if (!are_counts && image.dtype().kind() != 'f')
    reject("a depth image is of uint16 or of floats", "give image.astype(numpy.uint16), or metres");
  PointCloud cloud = are_counts ? import_pixels<std::uint16_t>(image, parameters, remarks)
                                : import_pixels<float>(image, parameters, remarks);
  show(remarks, 1);  // vpm/__init__.py stands between
  return cloud;
}

void bind_cloud(py::module_& module) {
  py::class_<PointCloud>(module, "PointCloud",
                         "Measured points with normals into free space. Immutable, thread-safe.")
      .def_static(
          "read", [](const Path& path) { return PointCloud::read(path.string()); }, py::arg("path"),
          py::call_guard<py::gil_scoped_release>(),
          "Reads a .vpmc file. Raises RefusedError, naming the first defect.")
      .def_static(
          "from_points",
          [](const Numbers& positions, const Numbers& normals) {
            const auto at = vectors_of(positions, "positions"), to = vectors_of(normals, "normals");
            const py::gil_scoped_release unlocked;
            return PointCloud::from_points(at, to);
          },
          py::arg("positions"), py::arg("normals"),
          "Makes the cloud of points that no camera's image holds.\n\npositions: (N, 3) in the "
          "world, m. normals: (N, 3) of any length, pointing into free space. Points that are not "
          "finite are left out. Raises ArgumentError if the numbers differ, RefusedError if fewer "
          "than two places remain. Thread-safe.")
      .def(
          "write", [](const PointCloud& cloud, const Path& path) { cloud.write(path.string()); },
          py::arg("path"), py::call_guard<py::gil_scoped_release>(),
          "Writes a .vpmc file, replacing it in one step. Raises WriteError.")
      .def("__len__", &PointCloud::size)
      .def_property_readonly(
          "has_camera", [](const PointCloud& cloud) { return cloud.camera().has_value(); },
          "True if the cloud is a depth image with its camera.")
      .def(
          "seen_from",
          [](const PointCloud& cloud, const Numbers& camera_pose) {
            return cloud.seen_from(pose_of(camera_pose));
          },
          py::arg("camera_pose"),
          "Returns the cloud with its camera elsewhere. Raises RefusedError without a camera.")
      .def("__repr__", [](const PointCloud& cloud) {
        return py::str("<vpm.PointCloud: {} points{}>")
            .format(cloud.size(), cloud.camera() ? ", a depth image" : "");
      });
  module.def(
      "import_cloud",
      [](const std::string& path, const py::kwargs& given) {
        const ImportParameters parameters = parameters_of(given);
        Remarks remarks;
        const auto import = [&] {
          const py::gil_scoped_release unlocked;
          return import_cloud(path, parameters, &remarks);
        };
        PointCloud cloud = import();
        show(remarks, 1);  // vpm/__init__.py stands between
        return cloud;
      },
      py::arg("path"),
      (std::string("Returns the cloud of a PNG, OpenEXR, TIFF, PGM, PFM, NPY, PCD or PLY "
                   "file.\n\n") +
       kImageArguments + kFileArguments + kImportSays)
          .c_str());
  module.def(
      "import_depth",
      [](const py::array& image, const py::kwargs& given) {
        return import_image(image, parameters_of(given));
      },
      py::arg("image"),
      (std::string("Returns the cloud of a depth image in memory: an array (height, width) of "
                   "uint16 counts or of floats, m, along the optical axis.\n\n") +
       kImageArguments + kImportSays)
          .c_str());
}

void bind_scene_body(py::module_& module) {
  py::class_<Body>(module, "Body", "Body made ready for queries. Immutable and thread-safe.")
      .def(py::init([](const PointCloud& cloud, bool denoising) {
             const py::gil_scoped_release unlocked;
             return Body(cloud, denoising_of(denoising));
           }),
           py::arg("cloud"), py::kw_only(), py::arg("denoising") = true,
           "Prepares a cloud for queries: a millisecond for a depth image, a second for as many "
           "points without a camera. denoising: frees points of most of their noise.")
      .def(py::init([](const SolidBody& solid, const py::object& to_world) {
             return Body(solid, to_world.is_none() ? Pose{} : pose_of(Numbers(to_world)));
           }),
           py::arg("solid"), py::arg("to_world") = py::none(),
           "Puts a vpm.SolidBody at a pose, mesh to world; without, at the origin. Takes no time: "
           "a solid that moves is made anew, or moved by `solids` of a query. Raises ArgumentError "
           "for a solid made without forces, RefusedError for a pose that is not rigid.")
      .def_static(
          "of_cameras",
          [](const std::vector<Body>& images) {
            const py::gil_scoped_release unlocked;
            return Body::of_cameras(images);
          },
          py::arg("images"),
          "Makes one body of the depth images of several cameras, which may see the same things "
          "from "
          "different sides: what they see counts once, and what one clearly saw free is free. The "
          "order changes no bit. Raises ArgumentError for none, for more than 16, and for a body "
          "that is no depth image.")
      .def_property_readonly("is_solid", &Body::is_solid, "True if the body is a solid.")
      .def_property_readonly(
          "points", py::cpp_function(&Body::points, py::call_guard<py::gil_scoped_release>()),
          "Number of points with a normal; a solid has none.");
  py::class_<Scene>(module, "Scene",
                    "Bodies in one world frame, whose volumes, forces and torques add up. "
                    "Immutable and thread-safe.")
      .def(py::init<std::vector<Body>>(), py::arg("bodies"), "Makes a scene of several bodies.")
      .def(py::init<const Body&>(), py::arg("body"), "Makes a scene of one body.")
      .def(py::init([](const PointCloud& cloud) {
             const py::gil_scoped_release unlocked;
             return Scene(cloud);
           }),
           py::arg("cloud"), "Prepares a cloud and makes a scene of it: once, not for each pose.")
      .def_property_readonly("bodies", &Scene::bodies, "List of the bodies.");
}

// Returns where solids were, of a pose each, and a margin for all or each.
std::vector<SolidPlace> places_of(const Numbers& poses, const Numbers& margins) {
  std::vector<SolidPlace> places;
  for (const Pose& pose : poses_of(poses)) places.push_back({pose, 0});
  const bool is_one = margins.ndim() == 0;
  if (!is_one &&
      (margins.ndim() != 1 || margins.shape(0) != static_cast<py::ssize_t>(places.size())))
    reject("`margin` must be one number, m, or one for each solid");
  for (std::size_t k = 0; k < places.size(); ++k) places[k].margin = margins.data()[is_one ? 0 : k];
  return places;
}

// Returns the number of measured pixels that were removed from an image of float32, in place.
std::size_t remove_from(SolidRemover& remover, const py::array& image, const Numbers& intrinsics,
                        const Numbers& poses, const py::object& camera_pose,
                        const Numbers& margin) {
  using Metres = py::array_t<float, py::array::c_style>;
  if (!py::isinstance<Metres>(image) || image.ndim() != 2 || !image.writeable())
    reject("the image is written: it must be an array (height, width) of float32, row by row",
           "give numpy.ascontiguousarray(image, numpy.float32)");
  const Camera camera{intrinsics_of(intrinsics), static_cast<std::uint32_t>(image.shape(1)),
                      static_cast<std::uint32_t>(image.shape(0)),
                      camera_pose.is_none() ? Pose{} : pose_of(Numbers(camera_pose))};
  const std::vector<SolidPlace> places = places_of(poses, margin);
  const std::span<float> depth(static_cast<float*>(Metres(image).mutable_data()),
                               static_cast<std::size_t>(image.size()));
  const py::gil_scoped_release unlocked;
  return remover.remove(places, camera, depth);
}

void bind_remover(py::module_& module) {
  constexpr const char* kPlaces =
      "poses: (S, 7) or (S, 4, 4), mesh to world at the time of the image, one for each solid. "
      "margin: m, one number or (S,): no point of a solid was further from where its pose puts "
      "it.\n\n";
  py::class_<RemovedSolid>(module, "RemovedSolid",
                           "What a depth image told of a solid that was removed from it.")
      .def_readonly("in_view", &RemovedSolid::in_view,
                    "Number of pixels that show the solid, if nothing is before it.")
      .def_readonly("hidden", &RemovedSolid::hidden,
                    "Number of those that were measured before it.")
      .def_readonly("explained", &RemovedSolid::explained,
                    "Number of those that were measured where it is. If many are neither hidden "
                    "nor explained, the pose is probably another.")
      .def_readonly("holds_camera", &RemovedSolid::holds_camera,
                    "True if the camera is inside of the solid, which hides all then.");
  py::class_<SolidRemover>(
      module, "SolidRemover",
      "Takes known solids at known poses, such as a robot's links and what its hand holds, out of "
      "depth images before they are bodies. What they hid is unseen, not free and no contact; what "
      "was measured before them stays. Belongs to one thread at a time.")
      .def(py::init([](const std::vector<SolidBody>& solids) { return SolidRemover(solids); }),
           py::arg("solids"),
           "solids: list of vpm.SolidBody, which may be made with with_force=False.")
      .def(
          "remove",
          [](SolidRemover& remover, const PointCloud& cloud, const Numbers& poses,
             const Numbers& margin) {
            const std::vector<SolidPlace> places = places_of(poses, margin);
            const py::gil_scoped_release unlocked;
            return remover.remove(places, cloud);
          },
          py::arg("cloud"), py::arg("poses"), py::arg("margin") = 0.0,
          (std::string("Returns the cloud of a depth image without the pixels of the solids.\n\n") +
           kPlaces +
           "Raises ArgumentError for another number of poses than of solids, RefusedError for a "
           "cloud that keeps no camera and for a pose that is none.")
              .c_str())
      .def("remove_from_image", &remove_from, py::arg("image"), py::arg("intrinsics"),
           py::arg("poses"), py::arg("camera_pose") = py::none(), py::arg("margin") = 0.0,
           (std::string("Marks the pixels in an array, as DepthStream.image() of metres, and "
                        "returns the number of those that had been measured.\n\nimage: (height, "
                        "width) of float32, m, which become -0. intrinsics: fx, fy, cx, cy, or a "
                        "matrix (3, 3). camera_pose: camera to world.\n") +
            kPlaces + "Raises what remove() raises, and ArgumentError for another kind of array.")
               .c_str())
      .def_property_readonly("found", &SolidRemover::found,
                             "List with the vpm.RemovedSolid of each solid, of the last image.");
}

// A stream with the size of its images.
struct SizedStream {
  DepthStream stream;
  std::uint32_t width, height;
  bool are_counts;
};

void bind_stream(py::module_& module) {
  py::class_<SizedStream>(module, "DepthStream",
                          "Depth images as a camera delivers them, made ready for queries; on a "
                          "device without a way back. Belongs to one thread at a time.")
      .def(py::init([](const Numbers& intrinsics, std::uint32_t width, std::uint32_t height,
                       std::optional<double> counts_per_metre, const std::string& device,
                       const std::string& method, int window, double edge_gate, bool denoising) {
             const DepthStreamOptions options{intrinsics_of(intrinsics),
                                              width,
                                              height,
                                              counts_per_metre,
                                              normals_of(method, window, edge_gate),
                                              device_from_text(device),
                                              denoising_of(denoising)};
             return SizedStream{DepthStream(options), width, height, counts_per_metre.has_value()};
           }),
           py::arg("intrinsics"), py::arg("width"), py::arg("height"), py::kw_only(),
           py::arg("counts_per_metre") = py::none(), py::arg("device") = "cpu",
           py::arg("method") = "inverse-depth", py::arg("window") = NormalOptions().window,
           py::arg("edge_gate") = kEdgeGate, py::arg("denoising") = true,
           "intrinsics: fx, fy, cx, cy in pixels, or a matrix (3, 3). counts_per_metre: images are "
           "uint16 counts; without, metres in float32. device: that of the queries. Raises "
           "ArgumentError, or UnavailableError if the device is not there.")
      .def(
          "image",
          [](const py::object& self) {
            auto& sized = self.cast<SizedStream&>();
            const std::vector<py::ssize_t> shape{sized.height, sized.width};
            if (sized.are_counts)
              return py::array(
                  py::array_t<std::uint16_t>(shape, sized.stream.counts().data(), self));
            return py::array(py::array_t<float>(shape, sized.stream.metres().data(), self));
          },
          "Returns the memory of the next image, (height, width), to be written before prepare() "
          "and not after it.")
      .def(
          "prepare",
          [](SizedStream& sized, const Numbers& camera_to_world) {
            const Pose pose = pose_of(camera_to_world);
            const py::gil_scoped_release unlocked;
            return sized.stream.prepare(pose);
          },
          py::arg("camera_to_world"),
          "Returns the vpm.Body of the image that was written, seen from this pose. Raises "
          "RefusedError, here or in the first query, for a pose or an image without any normal.");
}

}  // namespace

void bind_scene(py::module_& module) {
  bind_cloud(module);
  bind_scene_body(module);
  bind_remover(module);
  bind_stream(module);
}

}  // namespace vpm::python
