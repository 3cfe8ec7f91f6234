// The poses of a run in their scene, as one page: what vpm::View (vpm/view.h) holds.
#pragma once

#include <vpm/view.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/model/solid.h"
#include "libvpm/model/tool_model.h"
#include "libvpm/view/page.h"
#include "libvpm/view/shown_solids.h"

namespace vpm::view {

// Records poses, answers and states as they come. Members are those of vpm::View, if nothing else
// is told.
class PoseView {
 public:
  // Returns what each camera shows in a frame, by its number: as many of all frames, none of a
  // camera that has shown nothing yet.
  using Images = std::vector<std::optional<PointCloud>>;
  using Frames = std::function<Images(std::size_t)>;
  struct Answer {
    Pose pose;
    Result result;
    std::vector<std::uint8_t> states;
    std::vector<Contact> contacts;  // if they are asked for
  };

  PoseView(std::span<const Tool> tools, std::vector<std::string> names, const QueryOptions& options,
           std::string program);

  // Returns what a handle holds.
  static PoseView& of(const View& view) { return view.impl(); }

  // Shows another mesh of a tool than the surface that its model keeps.
  void set_mesh(std::size_t tool, Solid mesh) { meshes_[tool] = std::move(mesh); }
  void add_cloud(const std::string& name, const PointCloud& cloud);
  void add_solid(const std::string& name, const Body& body) { solids_.add(name, body); }
  // `names` has one for each camera, as it is to be shown.
  void set_frames(std::vector<std::string> names, Frames frames);
  void see_frame(std::optional<std::size_t> frame) { frame_ = frame; }

  std::size_t tools() const { return tools_.size(); }
  // Adds the answer at a job of a tool at its level of `level` spheres, 0 where none are to be
  // shown. Expects the tools in their order.
  void add(const Job& job, Answer answer, std::uint32_t level);
  // True if the next step need not be answered, unless it is the last one: it is not kept, and no
  // motion goes on from it.
  bool can_pass_over() const { return !keeps_next() && !options_.coherent; }
  void pass_over() { ++seen_; }

  // Returns the page of what was added.
  Page page() const;

 private:
  struct Step {
    std::size_t index = 0;
    std::optional<std::size_t> frame;
    std::vector<Pose> solids;     // none: where they were made
    std::vector<Answer> answers;  // one per tool
  };

  const ToolModel& model_of(std::size_t tool) const;
  bool keeps_next() const { return seen_ % every_ == 0; }
  void keep(Step step);
  std::vector<Step> kept() const;
  bool are_path(const std::vector<Step>& steps) const;
  void add_facts(Page& page) const;
  using Cameras = std::vector<std::vector<Camera>>;
  // Return the cameras of the frame that each step sees; empty without frames that have one.
  Cameras add_scene(Page& page, const std::vector<Step>& steps) const;
  Cameras add_frames(Page& page, const std::vector<Step>& steps) const;
  void add_camera(Page& page, std::size_t camera, std::span<const Images> frames,
                  std::span<const std::optional<std::size_t>> of_step, std::uint32_t stride) const;
  // Return the number of the column of volumes.
  std::size_t add_tool(Page& page, const std::vector<Step>& steps, std::size_t tool,
                       bool is_joined) const;
  std::size_t add_numbers(Page& page, const std::vector<Step>& steps, std::size_t tool,
                          std::size_t body) const;
  void add_contacts(Page& page, const std::vector<Step>& steps, std::size_t tool,
                    std::size_t body) const;
  std::string title() const;
  void say_what_is_odd(Page& page, const std::vector<Step>& steps,
                       const Cameras& frame_cameras) const;

  std::string program_;
  std::vector<Tool> tools_;
  std::vector<std::string> names_;
  std::vector<Solid> meshes_;  // empty where a model keeps none
  QueryOptions options_;
  std::vector<std::pair<std::string, PointCloud>> clouds_;
  ShownSolids solids_;
  std::vector<std::string> cameras_;  // their names
  Frames frames_;                     // none without a recording
  std::size_t most_steps_, seen_ = 0, every_ = 1;
  std::optional<std::size_t> frame_;
  std::vector<Step> steps_;
  Step current_, last_;
  std::vector<std::uint32_t> levels_;  // the finest that each tool used
};

}  // namespace vpm::view
