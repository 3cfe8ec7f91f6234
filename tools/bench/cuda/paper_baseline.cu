#include <algorithm>
#include <string>

#include "libvpm/device/cuda/device_array.h"
#include "libvpm/scene/cuda/device_cloud.h"
#include "tools/bench/cuda/paper_kernels.h"
#include "tools/bench/paper_baseline.h"

namespace vpm::bench {
namespace {

using cuda::check;
using cuda::CurrentDevice;
using cuda::DeviceArray;
using cuda::Event;

constexpr unsigned kThreads = 256;
constexpr std::uint32_t kPendingLaunches = 2048;  // fits what the device has room for

unsigned blocks_for(std::size_t threads) {
  return static_cast<unsigned>(std::max<std::size_t>(1, (threads + kThreads - 1) / kThreads));
}

// Returns the number of levels of nodes; children follow their parent.
int depth_of(const Hierarchy& tree) {
  std::vector<int> depth(tree.nodes.size(), 1);
  int deepest = 1;
  for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
    deepest = std::max(deepest, depth[n]);
    const HierarchyNode& node = tree.nodes[n];
    if (node.children_are_leaves != 0) continue;
    for (std::uint32_t k = node.begin; k < node.end; ++k) depth[k] = depth[n] + 1;
  }
  return deepest;
}

class PaperOnDevice : public PaperBaseline {
 public:
  // Copies everything to the current device, which must be the one of the query.
  PaperOnDevice(const ToolModel& tool, const Level& level, const PreparedCloud& cloud,
                Traversals traversals, int device)
      : device_(device),
        traversals_(traversals),
        tool_(tool),
        cloud_(cloud),
        spheres_(tool.spheres.data(), level.sphere_count),
        nodes_(level.hierarchy.nodes),
        leaves_(level.hierarchy.leaves),
        graph_begin_(level.graph.begin),
        neighbors_(level.graph.neighbors),
        positions_(cloud.positions()),
        normals_(cloud.normals()),
        contacts_(level.sphere_count),
        states_(level.sphere_count),
        below_(level.sphere_count),
        sphere_normals_(level.sphere_count),
        totals_(1) {
    if (depth_of(level.hierarchy) > PaperView::kMaxDepth)
      refuse("baseline: the sphere tree has more than " + std::to_string(PaperView::kMaxDepth) +
             " levels; make the model anew with vpm-graph");
    view_ = {spheres_.get(),        level.sphere_count,
             nodes_.get(),          leaves_.get(),
             graph_begin_.get(),    neighbors_.get(),
             measures_of(tool),     positions_.get(),
             normals_.get(),        static_cast<std::uint32_t>(cloud.positions().size()),
             contacts_.get(),       states_.get(),
             sphere_normals_.get(), below_.get(),
             totals_.get()};
    // Makes room for a launch for every sphere; each takes memory of the device.
    if (traversals == Traversals::launched)
      check(cudaDeviceSetLimit(cudaLimitDevRuntimePendingLaunchCount,
                               std::max(kPendingLaunches, level.sphere_count)));
  }

  Result run(const Pose& pose) override {
    const CurrentDevice current(device_);
    launch_boundary(pose);
    launch_flood();
    cuda::RawResult totals;
    check(cudaMemcpy(&totals, totals_.get(), sizeof totals, cudaMemcpyDeviceToHost));
    return result_of(totals, tool_, pose.rotation);
  }

  Phases run_in_phases(const Pose& pose) override {
    const CurrentDevice current(device_);
    check(cudaEventRecord(begin_.get()));
    launch_boundary(pose);
    check(cudaEventRecord(middle_.get()));
    launch_flood();
    check(cudaEventRecord(end_.get()));
    check(cudaEventSynchronize(end_.get()));
    return {microseconds_between(begin_, middle_), microseconds_between(middle_, end_)};
  }

  std::vector<SphereState> states() const override {
    const CurrentDevice current(device_);
    std::vector<std::uint32_t> words(states_.size());
    check(cudaMemcpy(words.data(), states_.get(), words.size() * sizeof(std::uint32_t),
                     cudaMemcpyDeviceToHost));
    std::vector<SphereState> states;
    for (const std::uint32_t word : words) states.push_back(static_cast<SphereState>(word));
    return states;
  }

 private:
  void launch_boundary(const Pose& pose) {
    check(cudaMemsetAsync(contacts_.get(), 0, contacts_.size() * sizeof(PaperContact)));
    check(cudaMemsetAsync(totals_.get(), 0, sizeof(cuda::RawResult)));
    gather_points<<<blocks_for(view_.point_count), kThreads>>>(
        view_, relative_to(pose, {{}, cloud_.origin()}), transpose(pose.rotation));
    find_boundary<<<blocks_for(view_.sphere_count), kThreads>>>(view_);
    check(cudaGetLastError());
  }

  void launch_flood() {
    const auto kernel = traversals_ == Traversals::launched ? flood_by_launches : flood;
    kernel<<<blocks_for(view_.sphere_count), kThreads>>>(view_);
    check(cudaGetLastError());
  }

  int device_;
  Traversals traversals_;
  const ToolModel& tool_;
  const PreparedCloud& cloud_;
  DeviceArray<Sphere> spheres_;
  DeviceArray<HierarchyNode> nodes_;
  DeviceArray<std::uint32_t> leaves_, graph_begin_, neighbors_;
  DeviceArray<Vec3f> positions_, normals_;
  DeviceArray<PaperContact> contacts_;
  DeviceArray<std::uint32_t> states_, below_;
  DeviceArray<Vec3> sphere_normals_;
  DeviceArray<cuda::RawResult> totals_;
  PaperView view_;
  Event begin_, middle_, end_;
};

}  // namespace

std::unique_ptr<PaperBaseline> make_paper_baseline(const ToolModel& tool, const Level& level,
                                                   const PreparedCloud& cloud,
                                                   Traversals traversals, int device) {
  const CurrentDevice current(device);
  return std::make_unique<PaperOnDevice>(tool, level, cloud, traversals, device);
}

}  // namespace vpm::bench
