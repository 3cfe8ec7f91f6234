// Limit on the work that one mesh may ask for. Counts operations, not seconds, so that the verdict
// on a mesh is the same on every machine and for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "libvpm/core/error.h"
#include "libvpm/core/vec3.h"

namespace vpm {

// Costs of operations, in units of about 10 ns: that of comparing two boxes.
namespace work {
inline constexpr std::uint64_t kBoxes = 1;
inline constexpr std::uint64_t kTriangles = 20;   // exact test of two triangles
inline constexpr std::uint64_t kMiss = 3;         // triangle near a ray, dismissed by its box
inline constexpr std::uint64_t kCrossing = 6;     // crossing of a ray and a triangle
inline constexpr std::uint64_t kSolidAngle = 15;  // one triangle about one point
inline constexpr std::uint64_t kPairFound = 24;   // bounds memory: 2 million in the small limit
inline constexpr std::uint64_t kPiece = 64;       // convex piece of a triangle; bounds memory too
}  // namespace work

// Called with the fraction of a mesh's checks that is done, on the calling thread.
using MeshProgress = std::function<void(double fraction)>;

// Refusal of a mesh that asks for more than the limit; `at` is a place where it does.
class TooMuchWork : public Error {
 public:
  TooMuchWork(const std::string& what, Vec3 place, const std::string& hint)
      : Error(ErrorKind::refused, what, {}, hint), at(place) {}
  Vec3 at;
};

class WorkLimit {
 public:
  // Half a second for each check of a mesh, and 10 microseconds more for each triangle: a megabyte
  // of file has 20 000.
  static constexpr std::uint64_t kLeast = 50'000'000, kPerTriangle = 1'000;

  explicit WorkLimit(std::size_t triangles) : most_(kLeast + kPerTriangle * triangles) {}

  std::uint64_t most() const { return most_; }
  std::uint64_t done() const { return done_; }
  // Counts work; false from the moment on that more than the limit was done.
  bool spend(std::uint64_t units) { return (done_ += units) <= most_; }

 private:
  std::uint64_t most_, done_ = 0;
};

// Calls work_of(k) for k in [0, count) in parallel, which returns the work it did, and stops with
// false soon after the limit. Where it stops depends on the work alone: items run in rounds, and
// work counts between these.
bool run_within(WorkLimit& limit, std::size_t count,
                const std::function<std::uint64_t(std::size_t)>& work_of,
                const MeshProgress& progress = {});

}  // namespace vpm
