// What two solids share: SolidBody, Contact, Overlap, OverlapQuery.
#include <pybind11/stl.h>
#include <vpm/solid.h>

#include <cstdint>
#include <memory>
#include <optional>

#include "libvpm/python/arrays.h"
#include "libvpm/python/locked.h"

namespace vpm::python {
namespace {

void bind_body(py::module_& module) {
  py::class_<SolidBody>(module, "SolidBody",
                        "Solid made ready to be measured against others. Immutable, thread-safe.")
      .def(py::init([](const SolidMesh& solid, bool with_force) {
             const py::gil_scoped_release unlocked;
             return SolidBody(solid, with_force);
           }),
           py::arg("solid"), py::kw_only(), py::arg("with_force") = true,
           "Prepares a vpm.SolidMesh: 0.2 s for 7000 triangles; with_force False leaves out what "
           "forces need, which is most of that. Raises RefusedError for a mesh without volume.")
      .def(py::init([](const Tool& tool, bool with_force) {
             const py::gil_scoped_release unlocked;
             return SolidBody(tool, with_force);
           }),
           py::arg("tool"), py::kw_only(), py::arg("with_force") = true,
           "Prepares the surface that a vpm.Tool keeps, in the frame of its mesh. Raises "
           "RefusedError for a tool that keeps none.")
      .def_property_readonly("volume", &SolidBody::volume, "Volume, m^3.")
      .def_property_readonly(
          "center_of_mass", [](const SolidBody& body) { return array_of(body.center_of_mass()); },
          "Array (3,): centre of mass in the mesh's frame, m.")
      .def_property_readonly("radius", &SolidBody::radius,
                             "Largest distance of a point of the solid from the centre of mass, m.")
      .def_property_readonly("triangles", &SolidBody::triangles,
                             "Number of triangles that bound the solid.");
}

void bind_contact(py::module_& module) {
  py::class_<Contact>(module, "Contact",
                      "A connected patch of what two solids, or a tool and a body of a scene, "
                      "share; in world axes. Contacts of an answer add up to it in bits.")
      .def_property_readonly(
          "body",
          [](const Contact& contact) {
            return contact.body == Contact::kSeveralBodies ? std::nullopt
                                                           : std::optional(contact.body);
          },
          "Place of the body in the scene's list, 0 of two solids; None where the last contact "
          "sums "
          "those of several bodies.")
      .def_readonly("volume", &Contact::volume, "Volume, m^3.")
      .def_property_readonly(
          "centroid", [](const Contact& contact) { return array_of(contact.centroid); },
          "Array (3,): centroid of the volume, m.")
      .def_property_readonly(
          "normal", [](const Contact& contact) { return array_of(contact.normal); },
          "Array (3,): mean normal, from the first solid or the tool into the other; 0 if it "
          "cancels.")
      .def_readonly("area", &Contact::area, "Area of the cut surface as seen along it, m^2.")
      .def_readonly("depth", &Contact::depth, "Greatest depth, m.")
      .def_property_readonly(
          "force", [](const Contact& contact) { return array_of(contact.wrench.force); },
          "Array (3,): what it adds to the force of the answer.")
      .def_property_readonly(
          "torque", [](const Contact& contact) { return array_of(contact.wrench.torque); },
          "Array (3,): what it adds to the torque of the answer, about the same point.")
      .def_readonly("patches", &Contact::patches,
                    "Number of patches that it sums; more than 1 only in the last.")
      .def("__repr__", [](const Contact& contact) {
        return py::str("<vpm.Contact: {:.6g} m^3, {:.4g} m deep>")
            .format(contact.volume, contact.depth);
      });
}

void bind_answer(py::module_& module) {
  py::class_<Overlap>(module, "Overlap",
                      "What two solids a and b share, in world axes; b's vectors are the opposite.")
      .def_readonly("volume", &Overlap::volume, "Volume, m^3; 0 if they touch or are apart.")
      .def_property_readonly(
          "centroid", [](const Overlap& overlap) { return array_of(overlap.centroid); },
          "Array (3,): centroid of the shared solid, m.")
      .def_property_readonly(
          "area", [](const Overlap& overlap) { return array_of(overlap.area); },
          "Array (3,): gradient of the volume where a moves, m^2; from a into b.")
      .def_property_readonly(
          "turn", [](const Overlap& overlap) { return array_of(overlap.turn); },
          "Array (3,): gradient of the volume where a turns about the centroid, m^3.")
      .def_property_readonly(
          "force", [](const Overlap& overlap) { return array_of(overlap.wrench.force); },
          "Array (3,): force on a, N, or m^3 with stiffness 1.")
      .def_property_readonly(
          "torque", [](const Overlap& overlap) { return array_of(overlap.wrench.torque); },
          "Array (3,): torque on a about the centroid, N m, or m^4 with stiffness 1.")
      .def_readonly("closure", &Overlap::closure,
                    "How far the shared boundary is from closed, relative to the smaller radius; "
                    "below 1e-8.")
      .def_readonly("contacts", &Overlap::contacts,
                    "List of vpm.Contact, largest first, if the query asks for them.")
      .def("__repr__", [](const Overlap& overlap) {
        return py::str("<vpm.Overlap: {:.6g} m^3>").format(overlap.volume);
      });
}

void bind_overlap_query(py::module_& module) {
  using LockedQuery = Locked<OverlapQuery>;
  py::class_<LockedQuery>(module, "OverlapQuery",
                          "Measures two solids at many poses. Threads that ask it take turns.")
      .def(py::init([](const SolidBody& a, const SolidBody& b, bool with_force, double stiffness,
                       std::uint32_t contacts) {
             return std::make_unique<LockedQuery>(a, b,
                                                  OverlapOptions{with_force, stiffness, contacts});
           }),
           py::arg("a"), py::arg("b"), py::kw_only(), py::arg("with_force") = true,
           py::arg("stiffness") = 1.0, py::arg("contacts") = 0,
           "with_force: False leaves force and torque 0 and takes less time. stiffness: N/m^3. "
           "contacts: how many are listed each by itself, all others in one more; 0: none. "
           "Raises ArgumentError for forces of bodies made without.")
      .def(
          "run",
          [](LockedQuery& self, const Numbers& pose_a, const Numbers& pose_b) {
            const Pose a = pose_of(pose_a), b = pose_of(pose_b);
            return self.ask([&](OverlapQuery& query) { return query.run(a, b); });
          },
          py::arg("pose_a"), py::arg("pose_b"),
          "Returns the vpm.Overlap at poses that map the meshes to the world. Raises RefusedError "
          "for a pose that is not rigid, and where the boundary does not close.");
}

}  // namespace

void bind_overlap(py::module_& module) {
  bind_body(module);
  bind_contact(module);
  bind_answer(module);
  bind_overlap_query(module);
}

}  // namespace vpm::python
