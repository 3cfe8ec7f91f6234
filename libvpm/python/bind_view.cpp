// A page of poses in their scene, which a notebook shows: View.
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>
#include <vpm/view.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/python/arrays.h"
#include "libvpm/python/locked.h"

namespace vpm::python {
namespace {

// A view of one scene, with a query of its own: the one that it was made of keeps its last pose.
struct ShownScene {
  template <class Asked>
  ShownScene(ToolQuery<Asked>& of, const Scene& shown, const std::string& tool,
             const std::vector<std::string>& names, unsigned pixels)
      : view({of.tools.data(), 1}, {tool}, of.options, "vpm"), height(pixels) {
    const auto query =
        std::make_shared<Asked>(of.ask([](Asked& asked) { return asked.another(); }));
    view.add_scene(shown, names);
    add = [this, query, shown](std::span<const Job> jobs) { view.add_batch(*query, shown, jobs); };
  }
  ShownScene(const ShownScene&) = delete;
  ShownScene& operator=(const ShownScene&) = delete;

  View view;
  std::function<void(std::span<const Job>)> add;
  unsigned height;  // of the page in a notebook, pixels
};

// Adds one pose or many, which `poses` is by its shape, with the solids where they are at each.
void add_poses(ShownScene& shown, const Numbers& poses, const py::object& solids) {
  const bool is_one = poses.ndim() == 1 || (poses.ndim() == 2 && poses.shape(1) == 4);
  const std::vector<Pose> at = is_one ? std::vector<Pose>{pose_of(poses)} : poses_of(poses);
  const std::vector<Pose> moved = !is_one            ? poses_of_moving_solids(solids, at.size())
                                  : solids.is_none() ? std::vector<Pose>()
                                                     : poses_of(Numbers(solids));
  const std::vector<Job> jobs = jobs_of(at, moved);
  const py::gil_scoped_release unlocked;
  shown.add(jobs);
}

std::string html_of(const ShownScene& shown) {
  const py::gil_scoped_release unlocked;
  return shown.view.html();
}

// Returns the page as an element of another page, which it cannot reach.
std::string frame_of(const ShownScene& shown) {
  const py::object text = py::module_::import("html").attr("escape")(html_of(shown));
  return "<iframe sandbox=\"allow-scripts\" style=\"width: 100%; height: " +
         std::to_string(shown.height) + "px; border: 0\" srcdoc=\"" + text.cast<std::string>() +
         "\"></iframe>";
}

template <class Asked>
std::unique_ptr<ShownScene> make_view(ToolQuery<Asked>& query, const Scene& scene,
                                      const py::object& poses, const py::object& solids,
                                      const std::string& tool,
                                      const std::vector<std::string>& names, unsigned height) {
  auto shown = std::make_unique<ShownScene>(query, scene, tool, names, height);
  if (!poses.is_none()) add_poses(*shown, Numbers(poses), solids);
  return shown;
}

}  // namespace

void bind_view(py::module_& module) {
  constexpr const char* kAbout =
      "query: a vpm.Query, of which the first tool is shown, or a vpm.LevelQuery; its last pose "
      "stays. scene: the vpm.Scene that is shown. poses, solids: as for add(). tool, names: names "
      "of the tool, and of each body of the scene. height: pixels in a notebook.\n\nRaises "
      "UnavailableError if this build draws no pages, ArgumentError for another number of names "
      "than of bodies.";
  py::class_<ShownScene> view(
      module, "View",
      "Page of a tool at poses in its scene, with the answers: what vpm-query draws with --view. A "
      "notebook shows it where it is the last line of a cell; it asks for nothing of a network. "
      "Belongs to one thread at a time.");
  const auto add_init = [&](auto make) {
    view.def(py::init(make), py::arg("query"), py::arg("scene"), py::arg("poses") = py::none(),
             py::kw_only(), py::arg("solids") = py::none(), py::arg("tool") = "tool",
             py::arg("names") = std::vector<std::string>(), py::arg("height") = 560, kAbout);
  };
  add_init(&make_view<Query>);
  add_init(&make_view<LevelQuery>);
  view.def("add", &add_poses, py::arg("poses"), py::arg("solids") = py::none(),
           "Asks at a pose, (7,), (4, 4) or (3, 4), or at N poses, (N, 7), (N, 4, 4) or (N, 3, 4), "
           "and adds them to the page. Of many it keeps every n-th and the last one, 50 to 1000 of "
           "them.\n\nsolids: (S, 7) for a pose, (N, S, 7) for N poses, or matrices: where the "
           "scene's solids are, mesh to world. Raises what vpm.Query.run() raises.")
      .def_property_readonly("html", &html_of,
                             "Text of the page, some MB. Raises RefusedError if it has no pose.")
      .def(
          "save",
          [](const ShownScene& shown, const std::filesystem::path& path) {
            shown.view.write(path.string());
          },
          py::arg("path"), py::call_guard<py::gil_scoped_release>(),
          "Writes the page, which any browser opens, replacing a file in one step. Raises "
          "WriteError, and RefusedError if the page has no pose.")
      .def("_repr_html_", &frame_of,
           "Returns the page as an element of a notebook, to which it has no access.");
}

}  // namespace vpm::python
