// Queries that choose the tool's level of detail by what is asked of them.
#pragma once

#include <vpm/error.h>
#include <vpm/query.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace vpm {

struct LevelRequest {
  // Fraction of the tool's volume: the coarsest level whose calibrated worst error is at most this.
  std::optional<double> max_error;
  // Time of each query, s: the finest level that keeps it on this machine. Wins over the others,
  // and makes results depend on the machine's speed.
  std::optional<double> deadline_seconds;
  // The finest level without spheres that the scene's points cannot resolve.
  bool for_scene = false;

  bool asks() const { return max_error || deadline_seconds || for_scene; }
};

// How finely a scene's points tell its surface, m; medians over the surface.
struct SceneScale {
  double spacing = 0;    // between neighbouring points
  double noise = 0;      // standard deviation of the points about a smooth surface
  double curvature = 0;  // 1/m; larger principal curvature that nine tenths of the surface keep

  // Returns the radius of the smallest sphere that the points resolve: centred its radius behind
  // the surface it is on the wrong side of the points less than once in 40 cases.
  VPM_API double smallest_radius() const;
  // Returns the radius of the largest sphere within which the surface is a plane to the points'
  // resolution; infinite for a plane.
  VPM_API double largest_radius() const;
};

// Returns how finely the scene's points tell its surface within 1.5 tool radii of `place` (world,
// m), or everywhere where no place is given or too few points lie there: it tells how large the
// spheres of a tool should be before there is one (Tool::radius() says what its radius, m, will
// be). Of several bodies it is the scale of that which resolves the smallest spheres. Thread-safe;
// the same bits for any number of threads. Throws Error(refused) for a body of fewer than 32
// points, and Error(invalid_argument) for a scene of solids only and for a radius that is not above
// 0.
VPM_API SceneScale scene_scale(const Scene& scene, double tool_radius,
                               const std::optional<Vec3>& place = {});

// Says which part of a request chose the level.
enum class LevelReason {
  none,                     // nothing was requested: it is the finest
  max_error,                // the coarsest within LevelRequest::max_error
  scene,                    // the finest that LevelRequest::for_scene allows
  deadline,                 // the finest that keeps LevelRequest::deadline_seconds
  deadline_over_max_error,  // coarser than max_error asks for, to keep the deadline
  deadline_over_scene,      // coarser than the scene allows, to keep the deadline
  deadline_missed,          // the coarsest, which is expected to miss the deadline all the same
};

// A Query at the level that a request chooses; thread-safety and errors as for Query.
class VPM_API LevelQuery {
 public:
  // Chooses the level for the scene, and prepares the tool's surface if that has solids. With a
  // deadline the levels are timed here first, the tool put on places of the scene. `first_pose`
  // says where the tool will be, for the scene's scale. Throws Error(refused) if the tool has no
  // calibration, no level as accurate, or one level only where several are needed;
  // Error(invalid_argument) as Query, for an error that is no fraction, and for a level by deadline
  // or scene where the scene has solids only.
  LevelQuery(const Tool& tool, const QueryOptions& options, const LevelRequest& request,
             const Scene& scene, const Pose& first_pose);
  // The same for several tools, each at a level of its own, which are named by their place.
  LevelQuery(std::span<const Tool> tools, const QueryOptions& options, const LevelRequest& request,
             const Scene& scene, const Pose& first_pose);
  ~LevelQuery();
  LevelQuery(LevelQuery&&) noexcept;
  LevelQuery& operator=(LevelQuery&&) noexcept;

  // Returns a query for another thread, at the levels of this one, as Query::another().
  LevelQuery another() const;

  // Returns the answer of a tool at the level of the moment, and with a deadline chooses the next
  // one from the time that it took. Throws Error(invalid_argument), as all below, if there is no
  // such tool.
  Result run(const Scene& scene, const Pose& pose, std::size_t tool = 0,
             std::span<const Pose> solids = {});

  // Returns what Query::collides() does, at the level of the moment; a deadline learns nothing.
  Collides collides(const Scene& scene, const Pose& pose, double unseen_limit = kUnseenLimit,
                    std::size_t tool = 0, std::span<const Pose> solids = {});

  // Stores the answers of many jobs, as Query does, each at the level of its tool. Throws
  // Error(invalid_argument) also for a request with a deadline.
  void run(const Scene& scene, std::span<const Job> jobs, std::span<Result> results);

  // Returns the number of spheres of the level last used.
  std::uint32_t level(std::size_t tool = 0) const;
  // Returns the number of spheres of the finest level that the request allows.
  std::uint32_t finest_level(std::size_t tool = 0) const;
  // Returns the seconds that the last run took; for jobs, the mean of one.
  double seconds() const;
  // Returns why this level was used last.
  LevelReason reason(std::size_t tool = 0) const;
  // Returns the scene's scale, if the request is for it.
  std::optional<SceneScale> scale(std::size_t tool = 0) const;
  // Returns the state of each sphere at the last single pose, as Query::states().
  std::span<const SphereState> states(std::size_t tool = 0) const;
  // Returns what each body gave at the last single pose, as Query::parts().
  std::vector<Result> parts(std::size_t tool = 0) const;
  // Returns the contacts at the last single pose, as Query::contacts().
  std::vector<Contact> contacts(std::size_t tool = 0) const;

 private:
  struct Impl;
  explicit LevelQuery(std::unique_ptr<Impl> impl);
  Impl& impl() const;

  std::unique_ptr<Impl> impl_;  // null once moved from
};

}  // namespace vpm
