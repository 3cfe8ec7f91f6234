// Tool held by a device through a spring and a damper: VirtualCoupling and its limits.
#include <vpm/virtual_coupling.h>

#include "libvpm/python/arrays.h"

namespace vpm::python {
namespace {

CouplingParameters parameters_of(double stiffness, double damping, double mass, double gyration,
                                 double rate) {
  const CouplingParameters parameters{stiffness, damping, mass, gyration, rate};
  validate(parameters);
  return parameters;
}

void bind_limits(py::module_& module) {
  module.def("critical_mass", &critical_mass, py::arg("stiffness"), py::arg("damping"),
             "Returns the mass, kg, that the coupling moves without overshoot: damping^2 / (4 "
             "stiffness); N/m and N s/m.");
  module.def(
      "coupling_limits",
      [](double stiffness, double damping, double mass, double gyration, double rate) {
        const CouplingLimits limits =
            coupling_limits(parameters_of(stiffness, damping, mass, gyration, rate));
        py::dict told;
        told["contact_stiffness"] = limits.contact_stiffness;
        told["device_damping"] = limits.device_damping;
        return told;
      },
      py::kw_only(), py::arg("stiffness"), py::arg("damping"), py::arg("mass"), py::arg("gyration"),
      py::arg("rate") = CouplingParameters().rate,
      "Returns what a coupling's parameters imply: contact_stiffness, N/m, below which steps are "
      "stable; device_damping, N s/m, which the device must have to be passive at this rate.");
  module.def(
      "stable_rate",
      [](double contact_stiffness, double stiffness, double damping, double mass, double gyration) {
        return stable_rate(
            parameters_of(stiffness, damping, mass, gyration, CouplingParameters().rate),
            contact_stiffness);
      },
      py::arg("contact_stiffness"), py::kw_only(), py::arg("stiffness"), py::arg("damping"),
      py::arg("mass"), py::arg("gyration"),
      "Returns the lowest rate, 1/s, at which a contact of this stiffness, N/m, is stable.");
}

}  // namespace

void bind_haptics(py::module_& module) {
  bind_limits(module);
  py::class_<VirtualCoupling>(module, "VirtualCoupling",
                              "Tool held by a haptic device through a spring and a damper, and "
                              "pushed out of the scene by the measured contact (Adams and "
                              "Hannaford 1999). Belongs to one thread at a time.")
      .def(py::init([](const Numbers& center_of_mass, const Numbers& device, double stiffness,
                       double damping, double mass, double gyration, double rate) {
             return VirtualCoupling(parameters_of(stiffness, damping, mass, gyration, rate),
                                    vector_of(center_of_mass, "center_of_mass"), pose_of(device));
           }),
           py::arg("center_of_mass"), py::arg("device"), py::kw_only(), py::arg("stiffness"),
           py::arg("damping"), py::arg("mass"), py::arg("gyration"),
           py::arg("rate") = CouplingParameters().rate,
           "Starts with the tool at rest at the device's pose.\n\ncenter_of_mass: (3,), m, as "
           "Tool.center_of_mass. stiffness N/m, damping N s/m, mass kg, gyration m, rate steps "
           "per second. Raises ArgumentError for parameters that are not positive.")
      .def_property_readonly(
          "tool", [](const VirtualCoupling& coupling) { return matrix_of(coupling.tool()); },
          "Pose (4, 4) of the tool, at which the contact is to be measured.")
      .def(
          "advance",
          [](VirtualCoupling& coupling, const Numbers& device, const Numbers& force,
             const Numbers& torque) {
            const Wrench felt = coupling.advance(
                pose_of(device), {vector_of(force, "force"), vector_of(torque, "torque")});
            return py::make_tuple(array_of(felt.force), array_of(felt.torque));
          },
          py::arg("device"), py::arg("force"), py::arg("torque"),
          "Makes a step of 1 / rate: the device moves to a pose while the contact (N; N m about "
          "the centre of mass) pushes the tool. Returns force and torque on the device. Raises "
          "RefusedError, the state unchanged, for what is not finite.")
      .def(
          "energy",
          [](const VirtualCoupling& coupling) {
            const CouplingEnergy energy = coupling.energy();
            py::dict told;
            told["supplied"] = energy.supplied;
            told["stored"] = energy.stored;
            told["dissipated"] = energy.dissipated;
            told["absorbed"] = energy.absorbed;
            told["lost"] = energy.lost;
            return told;
          },
          "Returns energies since the start, J: supplied = stored + dissipated + absorbed + lost.");
}

}  // namespace vpm::python
