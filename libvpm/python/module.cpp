// The Python module `vpm`: errors and devices, and the subjects of the other files.
#include <vpm/device.h>
#include <vpm/version.h>

#include "libvpm/python/arrays.h"

namespace vpm::python {
namespace {

const char* class_of(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::refused:
      return "RefusedError";
    case ErrorKind::invalid_argument:
      return "ArgumentError";
    case ErrorKind::unavailable:
      return "UnavailableError";
    case ErrorKind::cannot_write:
      return "WriteError";
  }
  return "Error";
}

// Raises the exception of vpm/_errors.py that tells the same.
void raise(const Error& error) {
  const py::object type = py::module_::import("vpm._errors").attr(class_of(error.kind()));
  const py::object raised = type(error.what());
  raised.attr("problem") = error.problem();
  raised.attr("where") = error.where();
  raised.attr("hint") = error.hint();
  PyErr_SetObject(type.ptr(), raised.ptr());
}

void bind_devices(py::module_& module) {
  module.def("cuda_device_count", &cuda_device_count,
             "Returns the number of CUDA devices that queries can run on; 0 without CUDA in the "
             "build, driver or device.");
  module.def(
      "device_name",
      [](const std::string& device) { return device_name(device_from_text(device)); },
      py::arg("device") = "auto",
      "Returns the names of all devices that \"cpu\", \"cuda\", \"cuda:1\", \"cuda:all\" or "
      "\"auto\" stands for.");
  module.def("set_thread_count", &set_thread_count, py::arg("threads"),
             "Caps the threads of all later work of the process; 0 means one per core. Changes no "
             "result. To be called once, before other work.");
}

}  // namespace

PYBIND11_MODULE(_vpm, module) {
  // Classes say that they are of `vpm`, where users find them.
  const py::object own_name = module.attr("__name__");
  module.attr("__name__") = "vpm";
  module.attr("__version__") = version();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      std::rethrow_exception(thrown);
    } catch (const Error& error) {
      raise(error);
    }
  });
  bind_devices(module);
  bind_solid(module);
  bind_overlap(module);
  bind_scene(module);
  bind_query(module);
  bind_device_arrays(module);
  bind_view(module);
  bind_haptics(module);
  module.attr("__name__") = own_name;
}

}  // namespace vpm::python
