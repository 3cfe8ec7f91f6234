// A page that shows tools at poses in their scene, with the answers: one HTML file that any browser
// opens without a network, and that asks for nothing else. Library vpm::solid.
//
//   const vpm::Tool tool = vpm::Tool::read("tool.vpmg");
//   const vpm::Scene scene(vpm::PointCloud::read("scene.vpmc"));
//   vpm::Query query(tool);                                   // <vpm/query.h>
//   vpm::View view({&tool, 1}, {"tool"});
//   view.add_scene(scene);
//   view.add({pose}, query.run(scene, pose), query);          // for each pose
//   view.write("poses.html");
#pragma once

#include <vpm/error.h>
#include <vpm/level_query.h>
#include <vpm/query.h>
#include <vpm/scene.h>
#include <vpm/tool.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpm {

namespace view {
class PoseView;  // the library's own
}

// Records poses, answers and states of spheres as they come. Of a long run it keeps every n-th pose
// and the last one, 50 to 1000 of them, so that its memory and the page, some 5 MB, stay small.
// Shares tools, clouds, bodies. Belongs to one thread at a time. Names are shown without folders.
class VPM_API View {
 public:
  // `names` are those of the tools, `options` those of the queries; `program` is named on the page.
  // Throws Error(unavailable) if this build draws no pages, Error(invalid_argument) unless each of
  // one tool or more has a name.
  View(std::span<const Tool> tools, std::vector<std::string> names,
       const QueryOptions& options = {}, const std::string& program = "vpm");
  ~View();
  View(View&&) noexcept;
  View& operator=(View&&) noexcept;

  // Adds a cloud to the scene of all poses.
  void add_cloud(const std::string& name, const PointCloud& cloud);
  // Adds a solid to the scene of all poses. Throws Error(invalid_argument) for another body.
  void add_solid(const std::string& name, const Body& solid);
  // Adds all bodies of a scene, as queries see them: depth images with narrow holes closed, each
  // camera's by itself. `names` has one for each body; none: "body 0" and so on. Throws
  // Error(invalid_argument) for another number of names.
  void add_scene(const Scene& scene, std::span<const std::string> names = {});
  // Makes the frames of a recording the scene. `frame` returns the cloud of a frame, by the number
  // that see_frame() was given; html() and write() call it for the frames that the page shows.
  void set_frames(const std::string& name, std::function<PointCloud(std::size_t)> frame);
  // Sets the frame that the next poses see.
  void see_frame(std::optional<std::size_t> frame);

  // Adds the answer of the query to its last pose, that of the job's tool, with the solids where
  // the job has them. Expects all tools at a pose, in their order. Throws Error(invalid_argument)
  // for another tool; a Query tells of its first one only.
  void add(const Job& job, const Result& result, const Query& query);
  void add(const Job& job, const Result& result, const LevelQuery& query);
  // Adds jobs of the first tool, and the same of the other tools. Queries those that are kept, and
  // the last one, again, since a batch leaves no states of spheres; of coherent poses all. Throws
  // what the query throws.
  void add_batch(Query& query, const Scene& scene, std::span<const Job> jobs);
  void add_batch(LevelQuery& query, const Scene& scene, std::span<const Job> jobs);

  // Returns the page. Throws Error(refused) if no pose was added, Error(invalid_argument) if a job
  // moved another number of solids than were added, and what `frame` of set_frames() throws.
  std::string html() const;
  // Writes the page, replacing a file in one step; "-" is standard output. Throws the same, and
  // Error(cannot_write).
  void write(const std::string& path) const;

 private:
  friend view::PoseView;
  view::PoseView& impl() const;

  std::unique_ptr<view::PoseView> impl_;  // null once moved from
};

}  // namespace vpm
