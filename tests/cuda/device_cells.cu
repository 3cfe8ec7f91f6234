#include <cuda_runtime.h>

#include <memory>
#include <stdexcept>
#include <string>

#include "libvpm/query/measure_refined.h"
#include "tests/cuda/device_cells.h"

namespace vpm::testing {
namespace {

void check(cudaError_t status) {
  if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
}

// A copy of host values on the device.
template <class T>
class DeviceArray {
 public:
  DeviceArray(const T* values, std::size_t count) {
    check(cudaMalloc(&data_, (count + 1) * sizeof(T)));
    check(cudaMemcpy(data_, values, count * sizeof(T), cudaMemcpyHostToDevice));
  }
  explicit DeviceArray(const std::vector<T>& values) : DeviceArray(values.data(), values.size()) {}
  ~DeviceArray() { cudaFree(data_); }
  DeviceArray(const DeviceArray&) = delete;
  DeviceArray& operator=(const DeviceArray&) = delete;
  T* get() const { return data_; }

 private:
  T* data_ = nullptr;
};

struct LevelView {
  const CellBlock* blocks;
  const BlockMass* masses;
  const CellSample* samples;
  const std::uint32_t* block_begin;
  const Sphere* spheres;
  const double* reach;
  Vec3 center_of_mass;
  ToolReach tool_reach;

  VPM_HD CellView cell(std::uint32_t i) const {
    return {blocks,
            masses,
            samples,
            block_begin[i],
            block_begin[i + 1],
            spheres[i].center - center_of_mass,
            reach[i]};
  }
};

template <class Surface>
VPM_HD CellAnswer answer(const Surface& surface, const Pose& to_surface, const LevelView& level,
                         std::uint32_t i) {
  const CellView view = level.cell(i);
  CellMeasure<Surface> measure(surface, to_surface, level.tool_reach, view);
  const CellResult result = measure.run(SamplesInTurn{});
  const CutShare own{result.plane, to_surface * view.center, view.reach};
  const auto vouches = [&](Vec3 x, Vec3 foot) {
    return own.vouches_for(x, foot, level.tool_reach.length);
  };
  return {surface.side_of_ball(to_surface * view.center, view.reach), result,
          measure.whole(vouches)};
}

template <class Surface>
__global__ void measure_cells(Surface surface, Pose to_surface, LevelView level,
                              std::uint32_t count, CellAnswer* answers) {
  const std::uint32_t i = blockIdx.x * blockDim.x + threadIdx.x;
  if (i < count) answers[i] = answer(surface, to_surface, level, i);
}

template <class Surface>
std::vector<CellAnswer> launch(const Surface& surface, const Pose& to_surface,
                               const ToolModel& tool, const Level& level) {
  const DeviceArray<CellBlock> blocks(level.blocks);
  const DeviceArray<BlockMass> masses(block_masses(level));
  const DeviceArray<CellSample> samples(level.samples);
  const DeviceArray<std::uint32_t> block_begin(level.block_begin);
  const DeviceArray<Sphere> spheres(tool.spheres);
  const DeviceArray<double> reach(level.share_reach);
  std::vector<CellAnswer> answers(level.sphere_count);
  const DeviceArray<CellAnswer> device_answers(answers);
  constexpr unsigned kThreads = 64;
  measure_cells<<<(level.sphere_count + kThreads - 1) / kThreads, kThreads>>>(
      surface, to_surface,
      LevelView{blocks.get(),
                masses.get(),
                samples.get(),
                block_begin.get(),
                spheres.get(),
                reach.get(),
                tool.center_of_mass,
                {tool.reach, Shadows::near}},
      level.sphere_count, device_answers.get());
  check(cudaGetLastError());
  check(cudaMemcpy(answers.data(), device_answers.get(), answers.size() * sizeof(CellAnswer),
                   cudaMemcpyDeviceToHost));
  return answers;
}

}  // namespace

bool has_device() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

std::vector<CellAnswer> cells_on_host(const PreparedCloud& cloud, const ToolModel& tool,
                                      const Level& level, const Pose& to_surface) {
  const std::vector<BlockMass> masses = block_masses(level);
  const LevelView view{level.blocks.data(),  masses.data(),
                       level.samples.data(), level.block_begin.data(),
                       tool.spheres.data(),  level.share_reach.data(),
                       tool.center_of_mass,  {tool.reach, Shadows::near}};
  std::vector<CellAnswer> answers;
  for (std::uint32_t i = 0; i < level.sphere_count; ++i) {
    answers.push_back(cloud.is_organised() ? answer(cloud.depth_surface(), to_surface, view, i)
                                           : answer(cloud.disk_surface(), to_surface, view, i));
  }
  return answers;
}

std::vector<CellAnswer> cells_on_device(const PreparedCloud& cloud, const ToolModel& tool,
                                        const Level& level, const Pose& to_surface) {
  if (!cloud.is_organised()) {
    DiskSurface surface = cloud.disk_surface();
    const SettledDisks& disks = cloud.disks();
    const DeviceArray<Vec3f> feet(disks.feet), normals(disks.normals);
    const DeviceArray<std::uint32_t> second_of(disks.second_of);
    const DeviceArray<SecondPlane> seconds(disks.seconds);
    const DeviceArray<BoxQuad> boxes(surface.feet.boxes, surface.feet.quads());
    const DeviceArray<ConeQuad> cones(surface.cones.quads, surface.feet.quads());
    const DeviceArray<float> radii(surface.radii.of_points, surface.feet.count);
    const DeviceArray<float> largest(surface.radii.of_nodes, surface.feet.nodes());
    surface.feet.points = feet.get();
    surface.feet.boxes = boxes.get();
    surface.normals = normals.get();
    surface.second_of = second_of.get();
    surface.seconds = seconds.get();
    surface.cones.quads = cones.get();
    surface.radii = {radii.get(), largest.get()};
    return launch(surface, to_surface, tool, level);
  }
  DepthSurface surface = cloud.depth_surface();
  const std::size_t pixels =
      static_cast<std::size_t>(surface.width) * static_cast<std::size_t>(surface.height);
  const DeviceArray<Vec3f> normals(surface.normals, pixels);
  surface.normals = normals.get();
  const DeviceArray<float> measured(surface.measured, pixels);
  surface.measured = measured.get();
  std::vector<std::unique_ptr<DeviceArray<InverseDepthRange>>> tiles;
  for (int l = 0; l < surface.levels; ++l) {
    const std::size_t rows = static_cast<std::size_t>(((surface.height - 1) >> l) + 1);
    tiles.push_back(std::make_unique<DeviceArray<InverseDepthRange>>(
        surface.tiles[l], rows * static_cast<std::size_t>(surface.tiles_per_row(l))));
    surface.tiles[l] = tiles.back()->get();
  }
  return launch(surface, to_surface, tool, level);
}

}  // namespace vpm::testing
