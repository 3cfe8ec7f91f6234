// How much of a tool is inside a scene's solid, and which wrench pushes it out.
//
//   const vpm::Tool tool = vpm::Tool::read("tool.vpmg");
//   const vpm::Scene scene(vpm::PointCloud::read("scene.vpmc"));   // once per frame
//   vpm::Query query(tool);
//   const vpm::Result r = query.run(scene, pose);                  // a thousand times a second
#pragma once

#include <vpm/device_batch.h>
#include <vpm/error.h>
#include <vpm/query_types.h>
#include <vpm/scene.h>
#include <vpm/tool.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace vpm {

// Measures tools against scenes, by Kaluschke, Weller, Zachmann, "A Volumetric Penetration Measure
// for 6-DOF Haptic Rendering of Streaming Point Clouds" (2017), sections 3 and 4, as printed or
// refined. Shares its tools, so nothing dangles. Belongs to one thread at a time, and may use
// several inside; tools and scenes may be shared between threads. The same input gives the same
// bits on every device, for any number of threads and any order of a cloud's points.
class VPM_API Query {
 public:
  // Throws Error(invalid_argument) for options out of range or that exclude each other,
  // Error(unavailable) if the device is not there or has too little memory.
  explicit Query(const Tool& tool, const QueryOptions& options = {});
  // The same for several tools, which may have different levels: jobs name them by their place.
  // options.level must be a level of each. Coherent queries take one tool.
  explicit Query(std::span<const Tool> tools, const QueryOptions& options = {});
  ~Query();
  Query(Query&&) noexcept;
  Query& operator=(Query&&) noexcept;

  // Returns a query of the same tools and options for another thread, made sooner and with less
  // memory, since it shares their levels. Remembers no pose. Throws Error(unavailable) as the
  // constructor. With one for each thread and set_thread_count(1), N cores answer N times as many.
  Query another() const;

  // Returns the answer for the first tool at `pose` (tool to world coordinates). A rotation that is
  // off by rounding (1e-5) is taken for the nearest one. Allocates nothing after the first call on
  // a scene with one thread, unless contacts are asked for. Throws Error(refused) for a pose that
  // is not finite, not rigid or further than 2^100 m from the origin, and for solid shadows of
  // points without a camera; Error(unavailable) if the device fails.
  //
  // Solids of the scene are measured by the tool's surface and theirs, whatever the level, on the
  // CPU; `solids` moves them, as Job::solids does. The first call prepares the tool's surface (.2 s
  // for 7000 triangles). Throws Error(refused) for a tool without one, and where what is shared has
  // no closed boundary, a defect of a mesh; Error(invalid_argument) for another number of poses,
  // and for meshes by the measure as printed, which takes the spheres of both and has no closure.
  Result run(const Scene& scene, const Pose& pose, std::span<const Pose> solids = {});

  // Returns vpm::collides() of the answer at a pose. On the CPU it ends as soon as a part of the
  // tool is surely inside, or all of it is free: where the tool is inside, in a thirtieth of the
  // time of run(). Leaves states() and parts() unspecified. Throws what run() throws, and
  // Error(invalid_argument) for a limit outside of [0, 1].
  Collides collides(const Scene& scene, const Pose& pose, double unseen_limit = kUnseenLimit,
                    std::span<const Pose> solids = {});

  // Stores the answers of many jobs in their order: the bits of one by one, while a device takes
  // thousands of poses of up to 16 tools at once, and on the CPU each thread takes jobs of its own,
  // with memory like that of another() that is kept for the next jobs. Throws as run() of one pose,
  // and Error(invalid_argument) if there are not as many results as jobs, if a job names no tool of
  // the query, or a coherent one has several tools; the results are unspecified then.
  void run(const Scene& scene, std::span<const Job> jobs, std::span<Result> results);

  // Begins to answer poses of the first tool that lie in the memory of the query's device, and
  // returns before it has: neither poses nor answers pass through the host. The answers have the
  // bits of run(). Throws Error(invalid_argument) unless the options name one CUDA device, and for
  // a scene with solids, which the CPU measures; Error(unavailable) if the device fails.
  DeviceResults run(const Scene& scene, const DevicePoses& poses);

  // Ends a motion of coherent poses: the next pose does not follow from the last.
  void forget();

  // Returns the state of each sphere of the level at the last single pose; unspecified after jobs.
  // Valid until the next call. A device's states are fetched here.
  std::span<const SphereState> states() const;

  // Returns what each body gave at the last single pose, in the scene's order; the answer was their
  // sum. Unspecified after jobs.
  std::vector<Result> parts() const;

  // Returns the contacts at the last single pose, as many as QueryOptions::contacts asks for; they
  // add up to the answer. None for a volume of 0; unspecified after jobs and after collides().
  std::vector<Contact> contacts() const;

  // Returns the number of spheres of the level that is used of a tool.
  std::uint32_t level(std::size_t tool = 0) const;

 private:
  struct Impl;
  explicit Query(std::unique_ptr<Impl> impl);
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

}  // namespace vpm
