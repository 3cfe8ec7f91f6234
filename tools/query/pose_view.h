// vpm-query --view: the poses of a run in their scene, as one page.
#pragma once

#include <vpm/level_query.h>
#include <vpm/scene.h>
#include <vpm/tool.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/import/import_cloud.h"
#include "libvpm/model/solid.h"
#include "libvpm/recording/recording.h"
#include "libvpm/view/page.h"
#include "tools/query/shown_solids.h"

namespace vpm::tools {

// Records poses, answers and states as they come and writes the page at the end. Keeps every n-th
// pose of a long run and the last one, so that its memory and the page stay small.
class PoseView {
 public:
  // Reads the meshes from the files of the tools, `names`. The tools must outlive this. Throws
  // Error(unavailable) if this build draws no pages.
  PoseView(std::string path, std::span<const Tool> tools, std::vector<std::string> names,
           const QueryOptions& options);

  // Adds a cloud to the scene of all poses.
  void add_cloud(const std::string& name, const PointCloud& cloud);
  // Adds a solid, of that file, to the scene of all poses.
  void add_solid(const std::string& name, const Body& body) { solids_.add(name, body); }
  // Makes the frames of a recording the scene. The recording must outlive this.
  void set_frames(const std::string& name, const Recording& recording,
                  const ImportOptions& options);

  // Adds the answer of the query to its last pose, that of the job's tool, with the solids where
  // the job has them. Expects the tools in their order.
  void add(const Job& job, const Result& result, const LevelQuery& query);
  // Adds jobs of the first tool that were answered together, and the same of the other tools.
  // Queries those that are kept, and the last one, again, since a batch leaves no states of
  // spheres.
  void add_batch(LevelQuery& query, const Scene& scene, std::span<const Job> jobs);
  // Sets the frame of the recording that the next steps see.
  void see_frame(std::optional<std::size_t> frame) { frame_ = frame; }

  // Writes the page. Throws Error(refused) if no pose was added.
  void write() const;

 private:
  struct Answer {
    Pose pose;
    Result result;
    std::vector<std::uint8_t> states;
    std::vector<Contact> contacts;  // if they are asked for
  };
  struct Step {
    std::size_t index = 0;
    std::optional<std::size_t> frame;
    std::vector<Pose> solids;     // none: where they were made
    std::vector<Answer> answers;  // one per tool
  };

  bool keeps_next() const { return seen_ % every_ == 0; }
  void keep(Step step);
  std::vector<Step> kept() const;
  bool are_path(const std::vector<Step>& steps) const;
  void add_facts(view::Page& page) const;
  // Return the camera of the frame that each step sees; empty without frames that have one.
  std::vector<Camera> add_scene(view::Page& page, const std::vector<Step>& steps) const;
  std::vector<Camera> add_frames(view::Page& page, const std::vector<Step>& steps) const;
  // Return the number of the column of volumes.
  std::size_t add_tool(view::Page& page, const std::vector<Step>& steps, std::size_t tool,
                       bool is_joined) const;
  std::size_t add_numbers(view::Page& page, const std::vector<Step>& steps, std::size_t tool,
                          std::size_t body) const;
  void add_contacts(view::Page& page, const std::vector<Step>& steps, std::size_t tool,
                    std::size_t body) const;
  std::string title() const;
  void say_what_is_odd(view::Page& page, const std::vector<Step>& steps,
                       const std::vector<Camera>& frame_cameras) const;

  std::string path_;
  std::vector<const ToolModel*> models_;
  std::vector<std::string> names_;
  std::vector<Solid> meshes_;  // empty where a model came by a pipe or keeps none
  QueryOptions options_;
  std::vector<std::pair<std::string, PointCloud>> clouds_;
  ShownSolids solids_;
  std::string recording_name_;
  const Recording* recording_ = nullptr;
  ImportOptions import_;
  std::size_t most_steps_, seen_ = 0, every_ = 1;
  std::optional<std::size_t> frame_;
  std::vector<Step> steps_;
  Step current_, last_;
  std::vector<std::uint32_t> levels_;  // the finest that each tool used
};

}  // namespace vpm::tools
