// Takes poses, vectors and choices from Python, and gives them back.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <vpm/camera.h>
#include <vpm/device.h>
#include <vpm/error.h>
#include <vpm/pose.h>
#include <vpm/query_types.h>
#include <vpm/remark.h>

#include <cstddef>
#include <initializer_list>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace vpm::python {

namespace py = pybind11;

// Array of doubles, row by row; made of whatever numpy can make one of.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

// Throws Error(invalid_argument).
[[noreturn]] void reject(const std::string& what, const std::string& hint = {});

// Returns the pose of 7 numbers "tx ty tz qx qy qz qw", or of a matrix of 4 x 4 or 3 x 4 numbers.
Pose pose_of(const Numbers& numbers);
// Returns N poses of N x 7, N x 4 x 4 or N x 3 x 4 numbers.
std::vector<Pose> poses_of(const Numbers& numbers);
// Returns the poses of all solids at N poses of the tool, one after another: N x S x 7 numbers, or
// N x S matrices; none for None.
std::vector<Pose> poses_of_moving_solids(const py::object& solids, std::size_t poses);
// Returns the jobs of the first tool at poses, which refer to as many poses of the solids each.
std::vector<Job> jobs_of(const std::vector<Pose>& poses, std::span<const Pose> solids);
// Returns a pose as a matrix of 4 x 4 numbers.
Numbers matrix_of(const Pose& pose);

// Returns three numbers, and an array of shape (3,).
Vec3 vector_of(const Numbers& numbers, const char* name);
Numbers array_of(const Vec3& v);
// Returns the vectors of an array of shape (N, 3).
std::vector<Vec3> vectors_of(const Numbers& numbers, const char* name);
// Returns an array of shape (N, 4): x, y, z and radius, m.
Numbers array_of(const std::vector<Sphere>& spheres);

// Returns the choice of this name. Throws Error(invalid_argument), naming all, if there is none.
template <class Choice>
Choice choice(const std::string& text, const char* name,
              std::initializer_list<std::pair<const char*, Choice>> choices) {
  std::string all;
  for (const auto& [known, value] : choices) {
    if (text == known) return value;
    all += std::string(all.empty() ? "\"" : ", \"") + known + "\"";
  }
  reject(std::string("`") + name + "` is \"" + text + "\", which is none of " + all);
}
CameraAxes axes_of(const std::string& text);
NormalMethod method_of(const std::string& text);
Denoising denoising_of(bool is_on);
Intrinsics intrinsics_of(const Numbers& numbers);

// Shows warnings by Python's `warnings`, as vpm.SetupWarning, and notes by the logger "vpm".
// Warnings are told to come from `callers` above the function of the module that was called.
void show(const Remarks& remarks, int callers = 0);

// Define the classes and functions of one subject each.
void bind_solid(py::module_& module);
void bind_overlap(py::module_& module);
void bind_scene(py::module_& module);
void bind_query(py::module_& module);
void bind_device_arrays(py::module_& module);  // after bind_query
void bind_view(py::module_& module);
void bind_haptics(py::module_& module);

}  // namespace vpm::python
