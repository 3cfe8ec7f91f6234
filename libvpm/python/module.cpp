// The Python module `vpm`: errors and devices, and the subjects of the other files.
#include <vpm/device.h>
#include <vpm/version.h>

#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

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

// Breaks the lines of a docstring at blanks: pydoc shows them as they are, indented.
std::string in_lines(const std::string& doc) {
  constexpr std::size_t kLongest = 88;  // characters
  std::string text;
  std::istringstream lines(doc);
  for (std::string line; std::getline(lines, line); text += line + "\n")
    while (line.size() > kLongest) {
      const std::size_t blank = line.rfind(' ', kLongest);
      if (blank == line.npos) break;
      text += line.substr(0, blank) + "\n";
      line.erase(0, blank + 1);
    }
  return text.substr(0, text.find_last_not_of('\n') + 1);
}

// True if this is a function that pybind11 made, whose docstring is its to free.
bool is_ours(py::handle function) {
  return PyCFunction_Check(function.ptr()) &&
         PyCapsule_CheckExact(PyCFunction_GET_SELF(function.ptr()));
}

// Breaks the lines of the docstrings of all that the dictionary of the module or of its class has.
void break_lines(const py::dict& members) {
  for (const auto& [name, member] : members) {
    const bool is_static = Py_TYPE(member.ptr()) == &PyStaticMethod_Type;
    const py::object held = is_static ? py::object(member.attr("__func__"))
                                      : py::reinterpret_borrow<py::object>(member);
    const py::handle function = py::detail::get_function(held);
    const bool is_class =
        PyType_Check(member.ptr()) && py::str(member.attr("__module__")).equal(py::str("vpm"));
    if (is_ours(function)) {
      const char*& doc = reinterpret_cast<PyCFunctionObject*>(function.ptr())->m_ml->ml_doc;
      const std::string broken = in_lines(doc == nullptr ? "" : doc);
      std::free(const_cast<char*>(std::exchange(doc, ::strdup(broken.c_str()))));
    } else if (is_class || Py_TYPE(member.ptr()) == &PyProperty_Type) {
      const py::object doc = member.attr("__doc__");
      if (!doc.is_none()) member.attr("__doc__") = in_lines(doc.cast<std::string>());
      if (is_class) break_lines(member.attr("__dict__"));
    }
  }
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
  break_lines(module.attr("__dict__"));
  module.attr("__name__") = own_name;
}

}  // namespace vpm::python
