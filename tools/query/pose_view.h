// vpm-query --view: the poses of a run in their scene, as one page.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/import/import_cloud.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/recording/recording.h"
#include "libvpm/view/page.h"

namespace vpm::tools {

// Records poses, answers and states as they come and writes the page at the end. Of a long run it
// keeps every n-th pose and the last one, so that its memory and the page stay small.
class PoseView {
 public:
  // `names` are the models' files, which keep their meshes too. The models outlive this. Throws
  // Error(unavailable) where this build draws no pages.
  PoseView(std::string path, std::span<const ToolModel> models, std::vector<std::string> names,
           const QueryOptions& options);

  // The scene: clouds that do not change, or the frames of a recording, which outlives this.
  void add_cloud(const std::string& name, Cloud cloud);
  void set_frames(const std::string& name, const Recording& recording,
                  const ImportOptions& options);

  // Adds the answer of the tool's query to its last pose. Tools come in their order.
  void add(std::size_t tool, const Pose& pose, const Result& result, const ToolQuery& query);
  // Adds poses that were answered together, which leaves no states: those that are kept, and the
  // last, are asked again.
  void add_batch(ToolQuery& query, const PreparedCloud& cloud, std::span<const Pose> poses);
  void add_batch(std::span<ToolQuery* const> queries, const PreparedCloud& cloud,
                 std::span<const Pose> poses);
  // Says which frame of the recording the steps from here on see.
  void see_frame(std::optional<std::size_t> frame) { frame_ = frame; }

  void write() const;

 private:
  struct Answer {
    Pose pose;
    Result result;
    std::vector<std::uint8_t> states;
  };
  struct Step {
    std::size_t index = 0;
    std::optional<std::size_t> frame;
    std::vector<Answer> answers;  // one per tool
  };

  bool keeps_next() const { return seen_ % every_ == 0; }
  void keep(Step step);
  std::vector<Step> kept() const;
  void add_facts(view::Page& page) const;
  void add_scene(view::Page& page, const std::vector<Step>& steps) const;
  void add_frames(view::Page& page, const std::vector<Step>& steps) const;
  // Return the number of the column of volumes.
  std::size_t add_tool(view::Page& page, const std::vector<Step>& steps, std::size_t tool) const;
  std::size_t add_numbers(view::Page& page, const std::vector<Step>& steps, std::size_t tool,
                          std::size_t body) const;
  void say_what_is_odd(view::Page& page, const std::vector<Step>& steps) const;

  std::string path_;
  std::span<const ToolModel> models_;
  std::vector<std::string> names_;
  std::vector<Solid> meshes_;  // empty where a model came by a pipe or keeps none
  QueryOptions options_;
  std::vector<std::pair<std::string, Cloud>> clouds_;
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
