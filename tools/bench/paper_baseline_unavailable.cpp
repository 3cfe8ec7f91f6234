// Replaces cuda/ in a build without CUDA.
#include "libvpm/core/error.h"
#include "tools/bench/paper_baseline.h"

namespace vpm::bench {

std::unique_ptr<PaperBaseline> make_paper_baseline(const ToolModel&, const Level&,
                                                   const PreparedCloud&, Traversals, int) {
  throw Error(ErrorKind::unavailable, "this build of vpm-bench has no CUDA");
}

}  // namespace vpm::bench
