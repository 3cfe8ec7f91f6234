// How much of a tool is inside a scene: Query, LevelQuery, their results, and SetupCheck.
#include <pybind11/stl.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/setup_check.h>

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/python/arrays.h"
#include "libvpm/python/locked.h"

namespace vpm::python {
namespace {

Measure measure_of(const std::string& text) {
  return choice<Measure>(text, "measure",
                         {{"refined", Measure::refined}, {"paper", Measure::paper}});
}

QueryOptions options_of(const std::string& measure, std::uint32_t level, const std::string& device,
                        bool coherent, const std::string& shadows, double stiffness,
                        std::uint32_t contacts, bool interval) {
  return {measure_of(measure),
          level,
          device_from_text(device),
          coherent,
          choice<Shadows>(shadows, "shadows", {{"near", Shadows::near}, {"solid", Shadows::solid}}),
          stiffness,
          contacts,
          interval};
}

std::vector<Tool> tools_of(const py::object& tools) {
  if (py::isinstance<Tool>(tools)) return {tools.cast<Tool>()};
  return tools.cast<std::vector<Tool>>();
}

// Answers of many poses side by side. Its arrays share this memory.
struct Results {
  std::vector<Result> answers;

  const Result& at(py::ssize_t k) const {
    const auto count = static_cast<py::ssize_t>(answers.size());
    if (k < -count || k >= count) throw py::index_error();
    return answers[static_cast<std::size_t>(k < 0 ? k + count : k)];
  }
};

// Returns a member of all results as an array that shares their memory; `owner` is their object.
template <class Value>
py::array column_of(const py::object& owner, const Value Result::*member) {
  const auto& answers = owner.cast<const Results&>().answers;
  const Value* const first = answers.empty() ? nullptr : &(answers.front().*member);
  py::array_t<Value> column({answers.size()}, {sizeof(Result)}, first, owner);
  py::detail::array_proxy(column.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return column;
}
// Returns what a camera or points know, one fraction of it; None where nothing is told.
std::optional<double> fraction_of(const Result& result, double Visibility::*member) {
  if (!result.visibility) return std::nullopt;
  return (*result.visibility).*member;
}
// Returns that of all results as a new array, with NaN for None.
py::array fractions_of(const Results& results, double Visibility::*member) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  py::array_t<double> fractions(static_cast<py::ssize_t>(results.answers.size()));
  double* out = fractions.mutable_data();
  for (const Result& result : results.answers) *out++ = fraction_of(result, member).value_or(kNone);
  return fractions;
}
// Returns the closures of all results as a new array, with NaN for None.
py::array closures_of(const Results& results) {
  py::array_t<double> closures(static_cast<py::ssize_t>(results.answers.size()));
  double* out = closures.mutable_data();
  for (const Result& result : results.answers)
    *out++ = result.closure.value_or(std::numeric_limits<double>::quiet_NaN());
  return closures;
}
// Returns the bounds of the volume; None where nothing is told of them.
std::optional<std::pair<double, double>> interval_of(const Result& result) {
  if (!result.volume_interval) return std::nullopt;
  return std::pair{result.volume_interval->low, result.volume_interval->high};
}
// Returns those of all results as a new array of shape (N, 2), with NaN for None.
py::array intervals_of(const Results& results) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  py::array_t<double> bounds({results.answers.size(), std::size_t{2}});
  double* out = bounds.mutable_data();
  for (const Result& result : results.answers) {
    const auto [low, high] = interval_of(result).value_or(std::pair{kNone, kNone});
    *out++ = low;
    *out++ = high;
  }
  return bounds;
}
// Returns a vector of the wrench of all results as an array of shape (N, 3), which shares their
// memory.
py::array column_of(const py::object& owner, const Vec3 Wrench::*member) {
  const auto& answers = owner.cast<const Results&>().answers;
  const double* const first = answers.empty() ? nullptr : &(answers.front().wrench.*member).x;
  py::array_t<double> column({answers.size(), std::size_t{3}}, {sizeof(Result), sizeof(double)},
                             first, owner);
  py::detail::array_proxy(column.ptr())->flags &= ~py::detail::npy_api::NPY_ARRAY_WRITEABLE_;
  return column;
}

// Makes Python's enum of vpm::Collides, and returns it.
py::object bind_collides(py::module_& module) {
  py::dict values;
  values["no"] = static_cast<int>(Collides::no);
  values["yes"] = static_cast<int>(Collides::yes);
  values["unknown"] = static_cast<int>(Collides::unknown);
  py::object kind =
      py::module_::import("enum").attr("IntEnum")("Collides", values, py::arg("module") = "vpm");
  kind.attr("__doc__") =
      "Whether a tool is in a scene's solid: no, yes or unknown, which is that nothing of the tool "
      "is in it as far as anybody knows, but too much of the tool was not seen. Only no is "
      "false, so that an if takes what was not seen for an obstacle.";
  module.attr("Collides") = kind;
  return kind;
}

constexpr const char* kUnseenLimitIs =
    "unseen_limit: part of the tool that may be unseen or out of view where the answer is no, in "
    "[0, 1].";

// Returns the limit that an answer is asked with. Rejects one that is none.
double checked_limit(double unseen_limit) {
  if (!(unseen_limit >= 0 && unseen_limit <= 1)) reject("`unseen_limit` must lie in [0, 1]");
  return unseen_limit;
}

void bind_results(py::module_& module, const py::object& collides_kind) {
  py::class_<Result>(module, "Result", "Answer of a query at one pose.")
      .def_readonly("volume", &Result::volume, "Volume of the tool inside the scene's solid, m^3.")
      .def_readonly("volume_fraction", &Result::volume_fraction,
                    "That volume over the volume of the tool.")
      .def_property_readonly(
          "volume_interval", &interval_of,
          "(low, high), m^3, between which the true volume lies 95 times of 100, for noise and the "
          "tool's samples, not for what was not seen; None but for a query with interval=True.")
      .def_property_readonly(
          "seen_free",
          [](const Result& result) { return fraction_of(result, &Visibility::seen_free); },
          "Part of the tool before the surface that the scene's camera sees, or outside of what "
          "its points show; None for the paper measure. With volume_fraction, unseen and "
          "out_of_view it adds up to 1.")
      .def_property_readonly(
          "unseen", [](const Result& result) { return fraction_of(result, &Visibility::unseen); },
          "Part that the surface hides, without the volume, where nothing was measured, or where a "
          "scan is open; or None.")
      .def_property_readonly(
          "out_of_view",
          [](const Result& result) { return fraction_of(result, &Visibility::out_of_view); },
          "Part outside of the image, or behind the camera, 0 of points; or None.")
      .def_property_readonly(
          "force", [](const Result& result) { return array_of(result.wrench.force); },
          "Array (3,) in world axes, which pushes the tool out: N, or m^3 with stiffness 1.")
      .def_property_readonly(
          "torque", [](const Result& result) { return array_of(result.wrench.torque); },
          "Array (3,) in world axes about the tool's centre of mass: N m, or m^4 with stiffness 1.")
      .def_readonly("boundary", &Result::boundary, "Number of spheres that the surface cuts.")
      .def_readonly("inside", &Result::inside, "Number of spheres behind the surface that count.")
      .def_readonly("points", &Result::points,
                    "Number of points of the scene inside spheres; None but for the paper measure.")
      .def_readonly("closure", &Result::closure,
                    "In a scene with solids: how far the boundary of what is shared is from "
                    "closed, relative to the smaller radius, below 1e-8; the largest of all "
                    "solids. None without solids.")
      .def(
          "collides",
          [collides_kind](const Result& result, double unseen_limit) {
            return collides_kind(static_cast<int>(collides(result, checked_limit(unseen_limit))));
          },
          py::arg("unseen_limit") = kUnseenLimit,
          (std::string("Returns what the answer says as vpm.Collides.\n\n") + kUnseenLimitIs)
              .c_str())
      .def("__repr__", [](const Result& result) {
        const Vec3 f = result.wrench.force;
        return py::str(
                   "<vpm.Result: {:.4g} % of the tool, {:.6g} m^3, force ({:.4g}, {:.4g}, "
                   "{:.4g})>")
            .format(100 * result.volume_fraction, result.volume, f.x, f.y, f.z);
      });
  py::class_<Results>(module, "Results",
                      "Answers of many poses, in their order. Its arrays share one memory and "
                      "cannot be written.")
      .def("__len__", [](const Results& results) { return results.answers.size(); })
      .def("__getitem__", &Results::at, py::arg("index"), "Returns one vpm.Result.")
      .def_property_readonly(
          "volume", [](const py::object& self) { return column_of(self, &Result::volume); },
          "Array (N,), m^3.")
      .def_property_readonly(
          "volume_fraction",
          [](const py::object& self) { return column_of(self, &Result::volume_fraction); },
          "Array (N,).")
      .def_property_readonly("volume_interval", &intervals_of,
                             "Array (N, 2), m^3, NaN where a Result has None.")
      .def_property_readonly(
          "seen_free",
          [](const Results& results) { return fractions_of(results, &Visibility::seen_free); },
          "Array (N,), NaN where a Result has None.")
      .def_property_readonly(
          "unseen",
          [](const Results& results) { return fractions_of(results, &Visibility::unseen); },
          "Array (N,), NaN where a Result has None.")
      .def_property_readonly(
          "out_of_view",
          [](const Results& results) { return fractions_of(results, &Visibility::out_of_view); },
          "Array (N,), NaN where a Result has None.")
      .def_property_readonly(
          "force", [](const py::object& self) { return column_of(self, &Wrench::force); },
          "Array (N, 3) in world axes: N, or m^3 with stiffness 1.")
      .def_property_readonly(
          "torque", [](const py::object& self) { return column_of(self, &Wrench::torque); },
          "Array (N, 3) about the centre of mass: N m, or m^4 with stiffness 1.")
      .def_property_readonly(
          "boundary", [](const py::object& self) { return column_of(self, &Result::boundary); },
          "Array (N,) of spheres that the surface cuts.")
      .def_property_readonly(
          "inside", [](const py::object& self) { return column_of(self, &Result::inside); },
          "Array (N,) of spheres behind the surface that count.")
      .def_property_readonly("closure", &closures_of, "Array (N,), NaN where a Result has None.")
      .def(
          "collides",
          [](const Results& results, double unseen_limit) {
            py::array_t<std::uint8_t> found(static_cast<py::ssize_t>(results.answers.size()));
            std::uint8_t* out = found.mutable_data();
            const double limit = checked_limit(unseen_limit);
            for (const Result& result : results.answers)
              *out++ = static_cast<std::uint8_t>(collides(result, limit));
            return found;
          },
          py::arg("unseen_limit") = kUnseenLimit,
          "Returns an array (N,) of vpm.Collides as numbers, 0 no, 1 yes, 2 unknown: those of "
          "Result.collides().");
}

// Returns the poses of `solids`, of all of a scene at one pose of the tool; none for None.
std::vector<Pose> poses_of_solids(const py::object& solids) {
  if (solids.is_none()) return {};
  std::vector<Pose> poses = poses_of(Numbers(solids));
  if (poses.empty()) reject("`solids` has no pose", "leave it out, or give one of each solid");
  return poses;
}

// Sets the tools of jobs; those of None stay.
void set_tools(std::vector<Job>& jobs, const py::object& tool) {
  if (tool.is_none()) return;
  using Indices = py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>;
  const Indices tools(tool);
  if (tools.ndim() != 1 || tools.shape(0) != static_cast<py::ssize_t>(jobs.size()))
    reject("`tool` must have the shape (N,), an index for each pose");
  for (std::size_t k = 0; k < jobs.size(); ++k)
    jobs[k].tool = tools.at(static_cast<py::ssize_t>(k));
}

py::array array_of_states(const std::vector<SphereState>& states) {
  return py::array_t<std::uint8_t>(static_cast<py::ssize_t>(states.size()),
                                   reinterpret_cast<const std::uint8_t*>(states.data()));
}

Result answer(Query& query, const Scene& scene, const Pose& at, std::span<const Pose> solids) {
  return query.run(scene, at, solids);
}
Result answer(LevelQuery& query, const Scene& scene, const Pose& at, std::span<const Pose> solids) {
  return query.run(scene, at, 0, solids);
}
Collides hit(Query& query, const Scene& scene, const Pose& at, double unseen_limit,
             std::span<const Pose> solids) {
  return query.collides(scene, at, unseen_limit, solids);
}
Collides hit(LevelQuery& query, const Scene& scene, const Pose& at, double unseen_limit,
             std::span<const Pose> solids) {
  return query.collides(scene, at, unseen_limit, 0, solids);
}

// Binds what Query and LevelQuery are asked at single poses.
template <class Asked>
void bind_single_poses(py::class_<ToolQuery<Asked>>& query_class, const py::object& collides_kind) {
  using LockedQuery = ToolQuery<Asked>;
  query_class
      .def(
          "run",
          [](LockedQuery& self, const Scene& scene, const Numbers& pose, const py::object& solids) {
            const Pose at = pose_of(pose);
            const std::vector<Pose> moved = poses_of_solids(solids);
            return self.ask([&](Asked& query) { return answer(query, scene, at, moved); });
          },
          py::arg("scene"), py::arg("pose"), py::arg("solids") = py::none(),
          "Returns the vpm.Result of the first tool at a pose: 7 numbers tx ty tz qx qy qz qw, or "
          "a matrix (4, 4) or (3, 4); tool to world, m.\n\nsolids: (S, 7) or (S, 4, 4), a pose "
          "for each solid of the scene in the order of its bodies, mesh to world; without, they "
          "are where they were made.\n\nRaises RefusedError for a pose that is not finite or not "
          "rigid, for a tool that keeps no surface in a scene with solids, and where the boundary "
          "of what is shared does not close; ArgumentError for another number of poses than of "
          "solids.")
      .def(
          "collides",
          [collides_kind](LockedQuery& self, const Scene& scene, const Numbers& pose,
                          double unseen_limit, const py::object& solids) {
            const Pose at = pose_of(pose);
            const std::vector<Pose> moved = poses_of_solids(solids);
            return collides_kind(static_cast<int>(self.ask(
                [&](Asked& query) { return hit(query, scene, at, unseen_limit, moved); })));
          },
          py::arg("scene"), py::arg("pose"), py::arg("unseen_limit") = kUnseenLimit,
          py::arg("solids") = py::none(),
          (std::string("Returns whether the first tool is in the scene's solid at a pose: "
                       "run(...).collides() sooner, in a thirtieth of the time where the tool is "
                       "inside. Leaves states() and parts() unspecified.\n\n") +
           kUnseenLimitIs +
           "\nsolids: as for run().\n\nRaises what run() raises, and ArgumentError "
           "for a limit out of range.")
              .c_str())
      .def(
          "another",
          [](LockedQuery& self) {
            return std::make_unique<LockedQuery>(
                self.tools, self.options, self.ask([](Asked& query) { return query.another(); }));
          },
          "Returns a query of the same tools and options for another thread, whose levels it "
          "shares: threads with a query each do not wait for each other. Remembers no pose.")
      .def(
          "parts",
          [](LockedQuery& self) { return self.ask([](Asked& query) { return query.parts(); }); },
          "Returns a list with the vpm.Result that each body gave at the last single pose, in the "
          "order of the scene's bodies. Their volumes, forces and torques add up to the answer.")
      .def(
          "contacts",
          [](LockedQuery& self) { return self.ask([](Asked& query) { return query.contacts(); }); },
          "Returns a list of vpm.Contact, the largest first: those of the last single pose. Their "
          "volumes, forces and torques add up to the answer, in bits.");
}

void bind_single_query(py::module_& module, const py::object& collides_kind) {
  using LockedQuery = ToolQuery<Query>;
  py::class_<LockedQuery> query_class(
      module, "Query",
      "How much of a tool is inside a scene's solid, and which wrench pushes it out (Kaluschke, "
      "Weller, Zachmann 2017). Threads that ask one query take turns; other Python threads run "
      "meanwhile. The same input gives the same bits on every device, for any number of threads.");
  query_class
      .def(py::init([](const py::object& tools, const std::string& measure, std::uint32_t level,
                       const std::string& device, bool coherent, const std::string& shadows,
                       double stiffness, std::uint32_t contacts, bool interval) {
             const std::vector<Tool> list = tools_of(tools);
             const QueryOptions options = options_of(measure, level, device, coherent, shadows,
                                                     stiffness, contacts, interval);
             const py::gil_scoped_release unlocked;
             return std::make_unique<LockedQuery>(list, options, list, options);
           }),
           py::arg("tools"), py::kw_only(), py::arg("measure") = "refined", py::arg("level") = 0,
           py::arg("device") = "cpu", py::arg("coherent") = false, py::arg("shadows") = "near",
           py::arg("stiffness") = 1.0, py::arg("contacts") = 0, py::arg("interval") = false,
           "tools: a vpm.Tool, or a list of them.\nmeasure: \"refined\", or \"paper\", the "
           "algorithm as printed.\nlevel: number of spheres; 0: the finest level.\ndevice: "
           "\"cpu\", \"cuda\", \"cuda:1\", \"cuda:all\" or \"auto\".\ncoherent: the poses are "
           "those of one motion.\nshadows: what counts of the places that a depth image does not "
           "show. near: those at most the tool radius behind what it shows, and further behind "
           "those "
           "that a surface which cuts the tool supports. solid: all of them.\nstiffness: N/m^3; "
           "with 1 force and torque are in m^3 and "
           "m^4.\ncontacts: how many contacts() lists each by itself, all others in one more; 0: "
           "none. On the CPU only.\ninterval: answers tell volume_interval. On the CPU "
           "only.\n\nRaises ArgumentError for options out of range or that "
           "exclude each other, "
           "UnavailableError if the device is not there.")
      .def(
          "run_batch",
          [](LockedQuery& self, const Scene& scene, const Numbers& poses, const py::object& tool,
             const py::object& solids) {
            const auto count = static_cast<std::size_t>(poses.ndim() > 0 ? poses.shape(0) : 0);
            const std::vector<Pose> moved = poses_of_moving_solids(solids, count);
            std::vector<Job> jobs = jobs_of(poses_of(poses), moved);
            set_tools(jobs, tool);
            return self.ask([&](Query& query) {
              Results results{std::vector<Result>(jobs.size())};
              query.run(scene, jobs, results.answers);
              return results;
            });
          },
          py::arg("scene"), py::arg("poses"), py::arg("tool") = py::none(),
          py::arg("solids") = py::none(),
          "Returns the vpm.Results of N poses, (N, 7), (N, 4, 4) or (N, 3, 4); the bits of run() "
          "one by one.\n\ntool: (N,) index of each pose's tool; without, all are of the "
          "first.\nsolids: (N, S, 7) or (N, S, 4, 4), for each pose one of each of the scene's S "
          "solids.")
      .def(
          "forget", [](LockedQuery& self) { self.ask([](Query& query) { query.forget(); }); },
          "Ends a motion of coherent poses.")
      .def(
          "states",
          [](LockedQuery& self) {
            return array_of_states(self.ask([](Query& query) {
              const auto states = query.states();
              return std::vector<SphereState>(states.begin(), states.end());
            }));
          },
          "Returns the state of each sphere at the last single pose: an array (spheres,) of 0 "
          "outside, 1 cut by the surface, 2 inside.")
      .def(
          "level",
          [](LockedQuery& self, std::size_t tool) {
            return self.ask([&](Query& query) { return query.level(tool); });
          },
          py::arg("tool") = 0, "Returns the number of spheres that are used of a tool.");
  bind_single_poses(query_class, collides_kind);
}

const char* text_of(LevelReason reason) {
  switch (reason) {
    case LevelReason::none:
      return "none";
    case LevelReason::max_error:
      return "max_error";
    case LevelReason::scene:
      return "scene";
    case LevelReason::deadline:
      return "deadline";
    case LevelReason::deadline_over_max_error:
      return "deadline_over_max_error";
    case LevelReason::deadline_over_scene:
      return "deadline_over_scene";
    case LevelReason::deadline_missed:
      return "deadline_missed";
  }
  return "none";
}

void bind_level_query(py::module_& module, const py::object& collides_kind) {
  using LockedQuery = ToolQuery<LevelQuery>;
  py::class_<LockedQuery> query_class(
      module, "LevelQuery",
      "A query at the level of detail that a request chooses: that of the moment. What collides() "
      "is asked teaches a deadline nothing.");
  query_class
      .def(py::init([](const Tool& tool, const Scene& scene, const Numbers& first_pose,
                       std::optional<double> max_error, std::optional<double> deadline_seconds,
                       bool for_scene, const std::string& measure, const std::string& device,
                       const std::string& shadows, double stiffness, std::uint32_t contacts,
                       bool interval) {
             const Pose pose = pose_of(first_pose);
             const QueryOptions options =
                 options_of(measure, 0, device, false, shadows, stiffness, contacts, interval);
             const LevelRequest request{max_error, deadline_seconds, for_scene};
             const py::gil_scoped_release unlocked;
             return std::make_unique<LockedQuery>(std::vector<Tool>{tool}, options, tool, options,
                                                  request, scene, pose);
           }),
           py::arg("tool"), py::arg("scene"), py::arg("first_pose"), py::kw_only(),
           py::arg("max_error") = py::none(), py::arg("deadline_seconds") = py::none(),
           py::arg("for_scene") = false, py::arg("measure") = "refined", py::arg("device") = "cpu",
           py::arg("shadows") = "near", py::arg("stiffness") = 1.0, py::arg("contacts") = 0,
           py::arg("interval") = false,
           "max_error: fraction of the tool's volume that the calibrated worst error may "
           "be.\ndeadline_seconds: time of each query; wins over the others.\nfor_scene: no "
           "spheres that the scene's points cannot resolve.\n\nRaises RefusedError if the tool has "
           "no calibration or no such level.")
      .def_property_readonly(
          "level", [](LockedQuery& self) { return self.ask([](auto& q) { return q.level(); }); },
          "Number of spheres of the level last used.")
      .def_property_readonly(
          "seconds",
          [](LockedQuery& self) { return self.ask([](auto& q) { return q.seconds(); }); },
          "Seconds that the last run took.")
      .def_property_readonly(
          "reason",
          [](LockedQuery& self) { return text_of(self.ask([](auto& q) { return q.reason(); })); },
          "Which part of the request chose the level.");
  bind_single_poses(query_class, collides_kind);
}

void bind_registration(py::module_& module) {
  py::class_<Registration>(module, "Registration", "Where several cameras are by what they show.")
      .def_property_readonly(
          "camera_poses",
          [](const Registration& found) {
            py::list poses;
            for (const Pose& pose : found.to_world) poses.append(matrix_of(pose));
            return poses;
          },
          "Camera to world, a matrix (4, 4) for each image; PointCloud.seen_from() takes one.")
      .def_readonly("before", &Registration::before,
                    "By how much readings of one surface differed, m: robust deviation.")
      .def_readonly("after", &Registration::after, "By how much they differ now, m.")
      .def_readonly("motions", &Registration::motions,
                    "Motions of the cameras against each other: six for each but one.")
      .def_readonly("observable", &Registration::observable,
                    "How many of them the images tell; the others stay.");
  module.def(
      "register_cameras",
      [](const std::vector<Body>& images) {
        const py::gil_scoped_release unlocked;
        return register_cameras(images);
      },
      py::arg("images"),
      "Moves cameras, in the mean not at all, until surfaces that two of them show agree, by no "
      "more than the images tell. Returns a vpm.Registration.\n\nimages: depth images that "
      "Body.of_cameras() is to take, whose cameras are wrong by millimetres and tenths of a "
      "degree. Takes a core .2 s for four. Raises RefusedError for a camera that shares hardly a "
      "surface with others. Thread-safe.");
}

void bind_setup_check(py::module_& module) {
  py::class_<Remark>(module, "Remark", "What is said of a setup that is probably wrong.")
      .def_readonly("is_warning", &Remark::is_warning, "True if it is likely not what was meant.")
      .def_readonly("text", &Remark::text, "One sentence with its cure.")
      .def("__repr__", [](const Remark& remark) { return "<vpm.Remark: " + remark.text + ">"; });
  py::class_<SetupCheck>(module, "SetupCheck",
                         "Finds setups that are probably wrong: units, frames of poses and "
                         "cameras, unseen places. Belongs to one thread at a time.")
      .def(py::init(
               [](const py::object& tools, const PointCloud& cloud, const std::string& measure) {
                 const std::vector<Tool> list = tools_of(tools);
                 return SetupCheck(list, cloud, measure_of(measure));
               }),
           py::arg("tools"), py::arg("cloud"), py::kw_only(), py::arg("measure") = "refined",
           "tools: a vpm.Tool, or a list of them.")
      .def(
          "see",
          [](SetupCheck& check, const Numbers& pose, const Result& result, std::size_t tool) {
            check.see(pose_of(pose), result, tool);
          },
          py::arg("pose"), py::arg("result"), py::arg("tool") = 0,
          "Notes the answer that a query gave at a pose of a tool.")
      .def(
          "see",
          [](SetupCheck& check, const Numbers& poses, const Results& results) {
            const std::vector<Pose> at = poses_of(poses);
            if (at.size() != results.answers.size())
              reject(std::to_string(at.size()) + " poses, but " +
                     std::to_string(results.answers.size()) + " results");
            for (std::size_t k = 0; k < at.size(); ++k) check.see(at[k], results.answers[k]);
          },
          py::arg("poses"), py::arg("results"), "Notes the answers of a batch of the first tool.")
      .def("remarks", &SetupCheck::remarks,
           "Returns a list with a warning and its cure if something is probably wrong, else an "
           "empty one. Known in part before the first pose.");
  module.def(
      "doubted_camera",
      [](const std::vector<Body>& images) -> std::optional<std::pair<std::size_t, Remark>> {
        const py::gil_scoped_release unlocked;
        const std::optional<DoubtedCamera> doubted = doubted_camera(images);
        if (!doubted) return std::nullopt;
        return std::pair{doubted->camera, doubted->remark};
      },
      py::arg("images"),
      "Returns the place in the list of a camera that is probably not where its pose tells, and "
      "the "
      "vpm.Remark that says why; None where there is none.\n\nimages: depth images that "
      "Body.of_cameras() is to take. Takes a core 20 ms for four. Raises ArgumentError for a body "
      "that is no depth image. Thread-safe.");
  module.def(
      "uncertain_thickness",
      [](const std::vector<Body>& images) {
        const py::gil_scoped_release unlocked;
        return uncertain_thickness(images);
      },
      py::arg("images"),
      "Returns a vpm.Remark if depth images show both sides of a thing that is thinner than twice "
      "what their cameras disagree by, so that its volume is uncertain by half or more; else None."
      "\n\nimages: as for doubted_camera(). Takes a core 20 ms for four. Raises "
      "ArgumentError for a body that is no depth image. Thread-safe.");
}

}  // namespace

void bind_query(py::module_& module) {
  const py::object collides_kind = bind_collides(module);
  bind_results(module, collides_kind);
  bind_single_query(module, collides_kind);
  bind_level_query(module, collides_kind);
  bind_setup_check(module);
  bind_registration(module);
}

}  // namespace vpm::python
