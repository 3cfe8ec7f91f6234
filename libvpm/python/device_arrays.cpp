#include "libvpm/python/device_arrays.h"

#include <vpm/query.h>

#include <string>
#include <utility>

#include "libvpm/python/locked.h"

namespace vpm::python {
namespace {

constexpr const char *kNew = "dltensor", *kUsed = "used_dltensor";  // names of DLPack's capsules
constexpr int kDefaultStream = 1;                                   // as DLPack numbers it

// Returns the number of values of each pose, or 0 for shapes that no poses have.
std::uint32_t width_of(const DLTensor& tensor) {
  const std::int64_t* const shape = tensor.shape;
  if (tensor.ndim == 2 && shape[1] == 7) return 7;
  const bool is_matrix = tensor.ndim == 3 && shape[2] == 4 && (shape[1] == 3 || shape[1] == 4);
  return is_matrix ? static_cast<std::uint32_t>(4 * shape[1]) : 0;
}

bool has_gaps(const DLTensor& tensor) {
  std::int64_t expected = 1;
  for (int axis = tensor.ndim - 1; axis >= 0 && tensor.strides != nullptr; --axis) {
    if (tensor.shape[axis] > 1 && tensor.strides[axis] != expected) return true;
    expected *= tensor.shape[axis];
  }
  return false;
}

// What a tensor that is given away holds.
struct Given {
  std::shared_ptr<const DeviceAnswers> answers;
  std::array<std::int64_t, 2> shape, strides;
  DLManagedTensor tensor{};
};

void give_up(DLManagedTensor* tensor) {
  delete static_cast<Given*>(tensor->manager_ctx);
}

// Gives up a tensor that nobody took.
void forget(PyObject* capsule) {
  if (PyCapsule_IsValid(capsule, kNew) == 0) return;
  auto* const tensor = static_cast<DLManagedTensor*>(PyCapsule_GetPointer(capsule, kNew));
  tensor->deleter(tensor);
}

template <class Value>
auto column(Value DeviceResult::*member, std::int64_t width, DLDataType type = {kDLFloat, 64, 1}) {
  const DeviceResult row{};
  const auto offset =
      reinterpret_cast<const char*>(&(row.*member)) - reinterpret_cast<const char*>(&row);
  return [offset, width, type](const std::shared_ptr<DeviceAnswers>& answers) {
    return DeviceColumn{answers, static_cast<std::size_t>(offset), width, type};
  };
}

}  // namespace

TakenPoses::TakenPoses(const OnDevice& given) {
  const py::object capsule = given.array.attr("__dlpack__")(py::arg("stream") = kDefaultStream);
  auto* const tensor = static_cast<DLManagedTensor*>(PyCapsule_GetPointer(capsule.ptr(), kNew));
  if (tensor == nullptr) throw py::error_already_set();
  const DLTensor& t = tensor->dl_tensor;
  const std::uint32_t width = width_of(t);
  if (width == 0 || t.dtype.code != kDLFloat || t.dtype.bits != 64 || t.dtype.lanes != 1 ||
      has_gaps(t))
    reject(
        "poses on a device must be an array (N, 7), (N, 4, 4) or (N, 3, 4) of float64 without gaps",
        "make it double and contiguous");
  PyCapsule_SetName(capsule.ptr(), kUsed);  // now it is ours to give up
  tensor_ = tensor;
  poses_.numbers =
      reinterpret_cast<const double*>(static_cast<const char*>(t.data) + t.byte_offset);
  poses_.count = static_cast<std::size_t>(t.shape[0]);
  poses_.width = width;
}

TakenPoses::~TakenPoses() {
  const py::gil_scoped_acquire locked;  // whoever made the tensor may need it
  if (tensor_ != nullptr && tensor_->deleter != nullptr) tensor_->deleter(tensor_);
}

py::tuple DeviceColumn::shape() const {
  const std::size_t count = answers->results.size();
  if (width == 0) return py::make_tuple(count);
  return py::make_tuple(count, width);
}

py::capsule DeviceColumn::dlpack(const py::object& stream) const {
  const DeviceResults& results = answers->results;
  const auto number = stream.is_none() ? kDefaultStream : stream.cast<std::intptr_t>();
  if (number == 0) reject("0 names no stream of CUDA", "1 is the default stream");
  if (number > 0)
    results.wait_in(number == kDefaultStream ? nullptr : reinterpret_cast<void*>(number));
  auto given = std::make_unique<Given>();
  given->answers = answers;
  given->shape = {static_cast<std::int64_t>(results.size()), width};
  given->strides = {static_cast<std::int64_t>(sizeof(DeviceResult) / (type.bits / 8U)), 1};
  DLTensor& t = given->tensor.dl_tensor;
  t.data = const_cast<DeviceResult*>(results.rows());  // DLPack knows no constant memory
  t.device = {kDLCUDA, results.device().index};
  t.ndim = width == 0 ? 1 : 2;
  t.dtype = type;
  t.shape = given->shape.data();
  t.strides = given->strides.data();
  t.byte_offset = offset;
  given->tensor.manager_ctx = given.get();
  given->tensor.deleter = give_up;
  py::capsule capsule(&given->tensor, kNew, forget);
  static_cast<void>(given.release());
  return capsule;
}

void bind_device_arrays(py::module_& module) {
  constexpr DLDataType kCount{kDLInt, 32, 1};
  py::class_<DeviceColumn>(module, "DeviceArray",
                           "Array in the memory of a CUDA device. Others take it without a copy by "
                           "their from_dlpack(), as those of PyTorch, CuPy and JAX; then their "
                           "stream waits for it. It is not to be written.")
      .def_property_readonly("shape", &DeviceColumn::shape, "(N,) or (N, 3).")
      .def(
          "__dlpack__",
          [](const DeviceColumn& self, const py::object& stream, const py::kwargs&) {
            return self.dlpack(stream);
          },
          py::kw_only(), py::arg("stream") = py::none(), "Returns the array for DLPack.")
      .def(
          "__dlpack_device__",
          [](const DeviceColumn& self) {
            return py::make_tuple(static_cast<int>(kDLCUDA), self.answers->results.device().index);
          },
          "Returns the type and the number of the device, as DLPack numbers them.");
  py::class_<DeviceAnswers, std::shared_ptr<DeviceAnswers>>(
      module, "DeviceResults",
      "Answers of many poses in the memory of a CUDA device, which may still compute them. A pose "
      "that Query.run refuses has NaN. Each attribute is a vpm.DeviceArray.")
      .def("__len__", [](const DeviceAnswers& self) { return self.results.size(); })
      .def(
          "wait", [](const DeviceAnswers& self) { self.results.wait(); },
          py::call_guard<py::gil_scoped_release>(),
          "Returns when the answers are there. Not needed before from_dlpack().")
      .def_property_readonly("volume", column(&DeviceResult::volume, 0), "(N,), m^3.")
      .def_property_readonly("volume_fraction", column(&DeviceResult::volume_fraction, 0), "(N,).")
      .def_property_readonly("force", column(&DeviceResult::force, 3),
                             "(N, 3) in world axes: N, or m^3 with stiffness 1.")
      .def_property_readonly("torque", column(&DeviceResult::torque, 3),
                             "(N, 3) about the centre of mass: N m, or m^4 with stiffness 1.")
      .def_property_readonly("seen_free", column(&DeviceResult::seen_free, 0),
                             "(N,), NaN where a Result has None.")
      .def_property_readonly("unseen", column(&DeviceResult::unseen, 0),
                             "(N,), NaN where a Result has None.")
      .def_property_readonly("out_of_view", column(&DeviceResult::out_of_view, 0),
                             "(N,), NaN where a Result has None.")
      .def_property_readonly("boundary", column(&DeviceResult::boundary, 0, kCount),
                             "(N,) of spheres that the surface cuts.")
      .def_property_readonly("inside", column(&DeviceResult::inside, 0, kCount),
                             "(N,) of spheres behind the surface that count.");
  using LockedQuery = ToolQuery<Query>;
  py::class_<LockedQuery> query = module.attr("Query");
  query.def(
      "run_batch",
      [](LockedQuery& self, const Scene& scene, const OnDevice& given) {
        const auto poses = std::make_shared<const TakenPoses>(given);
        return std::make_shared<DeviceAnswers>(DeviceAnswers{
            poses, self.ask([&](Query& asked) { return asked.run(scene, poses->poses()); })});
      },
      py::arg("scene"), py::arg("poses"), py::prepend(),
      "Returns the vpm.DeviceResults of N poses of the first tool on a CUDA device: an array "
      "(N, 7), (N, 4, 4) or (N, 3, 4) of float64 with __dlpack__, as those of PyTorch and CuPy. "
      "Begins only: poses and results stay on the device of the query, which must be the same. The "
      "poses must not be written before the results are there.");
}

}  // namespace vpm::python
