#include "tools/bench/peers/fcl_pair.h"

namespace vpm::bench {

const bool kHasFcl = false;

std::unique_ptr<Peer> make_fcl_pair(const Solid&, const Solid&) {
  return nullptr;
}

}  // namespace vpm::bench
