#include "libvpm/python/arrays.h"

#include <array>

namespace vpm::python {
namespace {

std::string shape_of(const py::array& array) {
  std::string text = "(";
  for (py::ssize_t k = 0; k < array.ndim(); ++k)
    text += (k > 0 ? ", " : "") + std::to_string(array.shape(k));
  return text + ")";
}

constexpr const char* kPoses =
    "a pose is 7 numbers, tx ty tz qx qy qz qw, or a matrix of 4 x 4 or 3 x 4; tool (or camera) to "
    "world, m";

Pose pose_of_seven(const double* n) {
  return {rotation_from_quaternion({n[3], n[4], n[5], n[6]}), {n[0], n[1], n[2]}};
}
// `rows` is 3 or 4.
Pose pose_of_matrix(const double* n, py::ssize_t rows) {
  if (rows == 4 && !(n[12] == 0 && n[13] == 0 && n[14] == 0 && n[15] == 1))
    reject("the last row of a pose is not 0 0 0 1", "a transposed matrix has it as its column");
  const std::array<double, 9> rotation{n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10]};
  return {rotation_from_matrix(rotation), {n[3], n[7], n[11]}};
}

// Returns the pose that begins at a number, of an array whose last axes hold one from `axis` on.
Pose pose_at(const Numbers& numbers, py::ssize_t axis, const double* n) {
  const py::ssize_t axes = numbers.ndim() - axis;
  if (axes == 1 && numbers.shape(axis) == 7) return pose_of_seven(n);
  if (axes == 2 && numbers.shape(axis + 1) == 4 &&
      (numbers.shape(axis) == 4 || numbers.shape(axis) == 3))
    return pose_of_matrix(n, numbers.shape(axis));
  reject("the poses have the shape " + shape_of(numbers), kPoses);
}

}  // namespace

void reject(const std::string& what, const std::string& hint) {
  throw Error(ErrorKind::invalid_argument, what, {}, hint);
}

Pose pose_of(const Numbers& numbers) {
  return pose_at(numbers, 0, numbers.data());
}

std::vector<Pose> poses_of(const Numbers& numbers) {
  if (numbers.ndim() < 2) reject("the poses have the shape " + shape_of(numbers), kPoses);
  const py::ssize_t count = numbers.shape(0);
  std::vector<Pose> poses;
  poses.reserve(static_cast<std::size_t>(count));
  const py::ssize_t of_each = count > 0 ? numbers.size() / count : 0;
  for (py::ssize_t k = 0; k < count; ++k) try {
      poses.push_back(pose_at(numbers, 1, numbers.data() + k * of_each));
    } catch (const Error& error) {
      if (error.where().empty()) throw;  // of the array
      throw Error(error.kind(), error.problem(),
                  "pose " + std::to_string(k) + " of " + std::to_string(count) + ", from 0",
                  error.hint());
    }
  return poses;
}

std::vector<Pose> poses_of_moving_solids(const py::object& solids, std::size_t poses) {
  if (solids.is_none()) return {};
  Numbers numbers(solids);
  if (numbers.ndim() < 3 || numbers.shape(0) != static_cast<py::ssize_t>(poses) ||
      numbers.shape(1) == 0)
    reject(
        "`solids` must have the shape (N, S, 7) or (N, S, 4, 4): for each pose one of each "
        "solid");
  std::vector<py::ssize_t> shape(numbers.shape() + 1, numbers.shape() + numbers.ndim());
  shape[0] *= numbers.shape(0);
  return poses_of(numbers.reshape(shape));
}

std::vector<Job> jobs_of(const std::vector<Pose>& poses, std::span<const Pose> solids) {
  std::vector<Job> jobs(poses.size());
  const std::size_t moving = jobs.empty() ? 0 : solids.size() / jobs.size();
  for (std::size_t k = 0; k < jobs.size(); ++k)
    jobs[k] = {poses[k], 0, solids.subspan(k * moving, moving)};
  return jobs;
}

Numbers matrix_of(const Pose& pose) {
  const auto& [r0, r1, r2] = pose.rotation;
  const Vec3 t = pose.translation;
  const std::array<double, 16> numbers{r0.x, r0.y, r0.z, t.x, r1.x, r1.y, r1.z, t.y,
                                       r2.x, r2.y, r2.z, t.z, 0,    0,    0,    1};
  return Numbers({4, 4}, numbers.data());
}

Vec3 vector_of(const Numbers& numbers, const char* name) {
  if (numbers.ndim() != 1 || numbers.shape(0) != 3)
    reject(std::string("`") + name + "` has the shape " + shape_of(numbers) + ", not (3,)");
  return {numbers.at(0), numbers.at(1), numbers.at(2)};
}

Numbers array_of(const Vec3& v) {
  const std::array<double, 3> numbers{v.x, v.y, v.z};
  return Numbers(3, numbers.data());
}

std::vector<Vec3> vectors_of(const Numbers& numbers, const char* name) {
  if (numbers.ndim() != 2 || numbers.shape(1) != 3)
    reject(std::string("`") + name + "` has the shape " + shape_of(numbers) + ", not (N, 3)");
  std::vector<Vec3> vectors;
  vectors.reserve(static_cast<std::size_t>(numbers.shape(0)));
  const double* const n = numbers.data();
  for (py::ssize_t k = 0; k < numbers.size(); k += 3) vectors.push_back({n[k], n[k + 1], n[k + 2]});
  return vectors;
}

Numbers array_of(const std::vector<Sphere>& spheres) {
  static_assert(sizeof(Sphere) == 4 * sizeof(double));
  return Numbers({static_cast<py::ssize_t>(spheres.size()), py::ssize_t{4}},
                 spheres.empty() ? nullptr : &spheres.front().center.x);
}

CameraAxes axes_of(const std::string& text) {
  return choice<CameraAxes>(
      text, "axes",
      {{"opencv", CameraAxes::opencv}, {"opengl", CameraAxes::opengl}, {"ros", CameraAxes::ros}});
}

NormalMethod method_of(const std::string& text) {
  return choice<NormalMethod>(
      text, "method", {{"inverse-depth", NormalMethod::inverse_depth}, {"pca", NormalMethod::pca}});
}

Denoising denoising_of(bool is_on) {
  return is_on ? Denoising::on : Denoising::off;
}

Intrinsics intrinsics_of(const Numbers& n) {
  if (n.ndim() == 1 && n.shape(0) == 4) return {n.at(0), n.at(1), n.at(2), n.at(3)};
  if (n.ndim() == 2 && n.shape(0) == 3 && n.shape(1) == 3) {
    if (n.at(0, 1) != 0 || n.at(1, 0) != 0 || n.at(2, 0) != 0 || n.at(2, 1) != 0 || n.at(2, 2) != 1)
      reject("`intrinsics` is a matrix with skew, or no camera matrix",
             "a camera matrix is [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]");
    return {n.at(0, 0), n.at(1, 1), n.at(0, 2), n.at(1, 2)};
  }
  reject("`intrinsics` has the shape " + shape_of(n), "give fx, fy, cx, cy or a matrix of 3 x 3");
}

void show(const Remarks& remarks, int callers) {
  const py::module_ errors = py::module_::import("vpm._errors");
  for (const Remark& remark : remarks) {
    if (remark.is_warning) {
      if (PyErr_WarnEx(errors.attr("SetupWarning").ptr(), remark.text.c_str(), 1 + callers) != 0)
        throw py::error_already_set();
    } else {
      errors.attr("log").attr("info")("%s", remark.text);
    }
  }
}

}  // namespace vpm::python
