// FCL's collide with contacts between two meshes, where FCL is installed.
#pragma once

#include <memory>

#include "libvpm/model/solid.h"
#include "tools/bench/peers/peer.h"

namespace vpm::bench {

extern const bool kHasFcl;  // in this build

// Returns a peer that lists all contacts of mesh a against mesh b, which stays in place: the force
// is the sum of their depths along their normals. FCL tells no volume. Null unless kHasFcl.
std::unique_ptr<Peer> make_fcl_pair(const Solid& a, const Solid& b);

}  // namespace vpm::bench
