// What the neighbours of the measure answer, so that one suite can ask all of them alike.
#pragma once

#include <vpm/query_types.h>

#include <cmath>
#include <cstddef>

namespace vpm::bench {

// What a peer says of a tool at a pose; NaN where it says nothing.
struct PeerAnswer {
  double volume = NAN;  // m^3
  // World axes, about the tool's centre of mass; m^3 and m^4, or, of peers whose forces have no
  // such unit, times a factor of theirs.
  Wrench wrench{{NAN, NAN, NAN}, {NAN, NAN, NAN}};
  std::size_t contacts = 0;  // that the force sums
};

// A tool and a scene, ready to be asked by one thread.
class Peer {
 public:
  virtual ~Peer() = default;
  // `pose` maps the tool's mesh to the frame of the scene.
  virtual PeerAnswer query(const Pose& pose) = 0;
  // Returns the memory of what queries may read: of the tool and of the scene. A field covers no
  // more of the scene than the poses of a contest need.
  virtual std::size_t bytes() const = 0;
  // Returns that memory without its part for a field of the scene.
  virtual std::size_t bytes_without_field() const { return bytes(); }
};

}  // namespace vpm::bench
