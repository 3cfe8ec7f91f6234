#include <cstring>
#include <map>
#include <utility>

#include "libvpm/core/parallel.h"
#include "libvpm/device/cuda/device_array.h"
#include "libvpm/device/cuda/numbered_word.h"
#include "libvpm/device/cuda/occupancy.h"
#include "libvpm/solid/cuda/pair_measure.h"
#include "libvpm/solid/device_pairs.h"

namespace vpm::cuda {
namespace {

// Blocks that share a single pose, their threads, and those of each block in a batch.
constexpr unsigned kSinglePoseBlocks = 16, kSinglePoseThreads = 512, kPairThreads = 128;
// Of those on a multiprocessor. More would leave each thread fewer registers than it takes.
constexpr unsigned kPairBlocks = 4;
// Segments of a pose that there is room for: bunny-spot at 5 % has 295.
constexpr std::uint32_t kMostSegments = 4096;

struct PairJob {
  Pose pose;
  std::uint32_t pair;
};

// Words of a PairAnswer in the host's memory.
struct PairWords {
  static constexpr unsigned kSumWords = 2 * PairAnswer::kSums, kWords = kSumWords + 2;
  NumberedWord words[kWords] = {};
};

__global__ void __launch_bounds__(kSinglePoseThreads)
    single_pair(PairView pair, PairRoom room, Pose pose, PairCounts* shared, PairWords* answer,
                unsigned sequence) {
  PairMeasure<kSinglePoseThreads> measure(pair, room);
  if (!measure.run_part(pose, *shared, {blockIdx.x, gridDim.x})) return;
  bool has_room = false;
  unsigned undecided = 0;
  const double sum = measure.finish(has_room, undecided);
  const unsigned k = threadIdx.x;
  if (k < PairAnswer::kSums) {
    const auto* const halves = reinterpret_cast<const std::uint32_t*>(&sum);
    put(numbered(sequence, halves[0]), answer->words[2 * k]);
    put(numbered(sequence, halves[1]), answer->words[2 * k + 1]);
  }
  if (k == 0) put(numbered(sequence, undecided), answer->words[PairWords::kSumWords]);
  if (k == 1) put(numbered(sequence, has_room ? 1 : 0), answer->words[PairWords::kSumWords + 1]);
}

// Each block takes the next job when it has answered one.
__global__ void __launch_bounds__(kPairThreads, kPairBlocks)
    many_pairs(const PairView* pairs, const PairRoom* rooms, const PairJob* jobs, unsigned count,
               std::size_t shared_bytes, unsigned* next, PairAnswer* answers) {
  __shared__ unsigned job;
  for (;;) {
    __syncthreads();
    if (threadIdx.x == 0) job = atomicAdd(next, 1U);
    __syncthreads();
    if (job >= count) return;
    const PairView& pair = pairs[jobs[job].pair];
    bool has_room = false;
    unsigned undecided = 0;
    double sum = 0;
    if (PairLists<kPairThreads>::bytes(pair) <= shared_bytes)
      sum = PairMeasure<kPairThreads>(pair, rooms[blockIdx.x])
                .run(jobs[job].pose, has_room, undecided);
    PairAnswer& answer = answers[job];
    if (threadIdx.x < PairAnswer::kSums) reinterpret_cast<double*>(&answer)[threadIdx.x] = sum;
    if (threadIdx.x == 0) answer.undecided = undecided, answer.has_room = has_room ? 1 : 0;
  }
}

// A surface on the device.
class SurfaceCopy {
 public:
  explicit SurfaceCopy(const SurfaceView& on_host) : view_(on_host) {
    const std::size_t nodes = view_.node_count, triangles = view_.triangle_count;
    view_.vertices = memory_.copy(view_.vertices, view_.vertex_count);
    view_.triangles = memory_.copy(view_.triangles, triangles);
    view_.longest_edge = memory_.copy(view_.longest_edge, triangles);
    view_.parent_of = memory_.copy(view_.parent_of, triangles);
    view_.node_above = memory_.copy(view_.node_above, nodes);
    view_.bounds = memory_.copy(view_.bounds, 4 * nodes);
    view_.child = memory_.copy(view_.child, 4 * nodes);
    view_.probe = memory_.copy(view_.probe, nodes);
    view_.moments = memory_.copy(view_.moments, nodes);
    InsideView& inside = view_.inside;
    inside.state = memory_.copy(inside.state, view_.inside_states);
    inside.begin = memory_.copy(inside.begin, view_.inside_columns + 1);
    inside.entries = memory_.copy(inside.entries, view_.inside_entries);
    inside.vertices = view_.vertices, inside.triangles = view_.triangles;
  }
  const SurfaceView& view() const { return view_; }

 private:
  DeviceMemory memory_;
  SurfaceView view_;
};

// Memory of so many blocks, for surfaces of so many triangles together.
class PairRooms {
 public:
  PairRooms(unsigned count, std::uint32_t triangle_count)
      : triangles(triangle_count), last_segment_(std::size_t{count} * triangle_count) {
    last_segment_.clear();
    segments_ = DeviceArray<SharedSegment>(std::size_t{count} * kMostSegments);
    crossed_ = DeviceArray<std::uint32_t>(std::size_t{2} * count * kMostSegments);
    for (std::size_t k = 0; k < count; ++k) {
      std::uint32_t* const crossed = crossed_.get() + 2 * k * kMostSegments;
      rooms.push_back({last_segment_.get() + k * triangles,
                       segments_.get() + k * kMostSegments,
                       {crossed, crossed + kMostSegments},
                       kMostSegments});
    }
    on_device = DeviceArray<PairRoom>(rooms);
  }
  static std::size_t bytes(std::uint32_t triangles) {
    return sizeof(std::uint32_t) * triangles +
           kMostSegments * (sizeof(SharedSegment) + 2 * sizeof(std::uint32_t));
  }

  std::uint32_t triangles;
  std::vector<PairRoom> rooms;
  DeviceArray<PairRoom> on_device;

 private:
  DeviceArray<std::uint32_t> last_segment_, crossed_;
  DeviceArray<SharedSegment> segments_;
};

class PairsOnDevice : public DevicePairs {
 public:
  PairsOnDevice(int device, std::span<const SurfaceView> surfaces)
      : device_(device), shared_(1), next_(1) {
    shared_.clear();
    for (const SurfaceView& surface : surfaces) {
      copies_.emplace_back(surface);
      most_triangles_ = std::max(most_triangles_, copies_.back().view().triangle_count);
    }
    int most = 0;
    check(cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device));
    most_shared_ = static_cast<std::size_t>(most);
    for (const void* kernel :
         {reinterpret_cast<const void*>(single_pair), reinterpret_cast<const void*>(many_pairs)})
      check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, most - 1024));
  }

  void run(std::span<const SurfaceJob> jobs, std::span<PairAnswer> answers) override {
    const CurrentDevice current(device_);
    if (jobs.size() == 1) {
      answers.front() = run(jobs.front());
      return;
    }
    for (std::size_t begin = 0; begin < jobs.size(); begin += kJobs) {
      const std::size_t count = std::min(kJobs, jobs.size() - begin);
      run_part(jobs.subspan(begin, count), answers.subspan(begin, count));
    }
  }

 private:
  static constexpr std::size_t kJobs = 32768, kAnswersPerTask = 1024;
  static constexpr std::size_t kStaticShared = 1024;  // of a block, with what the driver takes

  // Returns the place of a job's pair in the list of pairs.
  std::uint32_t place_of(const SurfaceJob& job) {
    const auto [at, is_new] =
        places_.try_emplace({job.first, job.second}, static_cast<std::uint32_t>(pairs_.size()));
    if (is_new) {
      const SurfaceView &first = copies_[job.first].view(), &second = copies_[job.second].view();
      const double unit = unit_for(first.reach, second.reach);
      pairs_.push_back({{first, second}, 1 / unit, outgrows(second.reach, unit)});
    }
    return at->second;
  }

  PairAnswer run(const SurfaceJob& job) {
    const PairView& pair = pairs_[place_of(job)];
    const std::size_t bytes = PairLists<kSinglePoseThreads>::bytes(pair);
    if (bytes + kStaticShared > most_shared_) return {};
    if (!single_room_) single_room_ = std::make_unique<PairRooms>(1, 2 * most_triangles_);
    launch_kernel(single_pair, {kSinglePoseBlocks, kSinglePoseThreads, bytes},
                  LaunchKind::independent, stream_.get(), pair, single_room_->rooms[0], job.pose,
                  shared_.get(), answer_.device(), ++sequence_);
    return wait();
  }
  // Polls the host's own memory until the device has written all of the answer there.
  PairAnswer wait() {
    std::uint32_t words[PairWords::kWords];
    unsigned looks = 0;
    for (unsigned k = 0; k < PairWords::kWords;) {
      const NumberedWord word = poll(answer_.host()->words[k]);
      if (number_of(word) == sequence_) {
        words[k++] = value_of(word);
        continue;
      }
      if (++looks % kLooksPerCheck == 0) is_done(cudaStreamQuery(stream_.get()));
    }
    PairAnswer answer;
    static_assert(sizeof answer == sizeof words);
    std::memcpy(static_cast<void*>(&answer), words, sizeof words);
    return answer;
  }

  void run_part(std::span<const SurfaceJob> jobs, std::span<PairAnswer> answers) {
    if (!given_) given_ = std::make_unique<MappedArray<PairJob>>(kJobs);
    if (!results_on_host_) results_on_host_ = std::make_unique<MappedArray<PairAnswer>>(kJobs);
    std::size_t bytes = 0;  // of shared memory; pairs that need more have no room
    std::uint32_t pair = 0;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
      const bool is_as_before =
          k > 0 && jobs[k].first == jobs[k - 1].first && jobs[k].second == jobs[k - 1].second;
      if (!is_as_before) {
        pair = place_of(jobs[k]);
        const std::size_t needed = PairLists<kPairThreads>::bytes(pairs_[pair]);
        if (needed + kStaticShared <= most_shared_) bytes = std::max(bytes, needed);
      }
      given_->host()[k] = {jobs[k].pose, pair};
    }
    if (bytes > 0) launch(jobs.size(), bytes);
    parallel_for(jobs.size(), kAnswersPerTask, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k)
        answers[k] = bytes > 0 ? results_on_host_->host()[k] : PairAnswer{};
    });
  }
  // Answers the first jobs given, and returns when the answers are there.
  void launch(std::size_t count, std::size_t shared_bytes) {
    if (pairs_on_device_.size() < pairs_.size()) pairs_on_device_ = DeviceArray<PairView>(pairs_);
    int fit = 0;
    check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&fit, many_pairs, kPairThreads,
                                                        shared_bytes));
    const unsigned per_processor = std::clamp(static_cast<unsigned>(fit), 1U, kPairBlocks);
    if (!rooms_)
      rooms_ = make_teams<PairRooms>(
          teams_that_fit(PairRooms::bytes(2 * most_triangles_), kPairBlocks), 2 * most_triangles_);
    if (jobs_.size() == 0) jobs_ = DeviceArray<PairJob>(kJobs);
    if (results_.size() == 0) results_ = DeviceArray<PairAnswer>(kJobs);
    const unsigned blocks =
        std::min({static_cast<unsigned>(rooms_->rooms.size()), per_processor * processor_count(),
                  static_cast<unsigned>(count)});
    next_.clear();
    check(cudaMemcpyAsync(jobs_.get(), given_->host(), count * sizeof(PairJob),
                          cudaMemcpyHostToDevice, stream_.get()));
    launch_kernel(many_pairs, {blocks, kPairThreads, shared_bytes}, LaunchKind::independent,
                  stream_.get(), pairs_on_device_.get(), rooms_->on_device.get(), jobs_.get(),
                  static_cast<unsigned>(count), shared_bytes, next_.get(), results_.get());
    check(cudaMemcpyAsync(results_on_host_->host(), results_.get(), count * sizeof(PairAnswer),
                          cudaMemcpyDeviceToHost, stream_.get()));
    check(cudaStreamSynchronize(stream_.get()));
  }

  int device_;
  std::vector<SurfaceCopy> copies_;
  std::uint32_t most_triangles_ = 0;
  std::size_t most_shared_ = 0;  // bytes that a block may have
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> places_;  // of pairs
  std::vector<PairView> pairs_;
  Stream stream_;
  // Of single poses.
  std::unique_ptr<PairRooms> single_room_;
  DeviceArray<PairCounts> shared_;
  MappedArray<PairWords> answer_{1};
  unsigned sequence_ = 0;
  // Of batches.
  std::unique_ptr<PairRooms> rooms_;
  std::unique_ptr<MappedArray<PairJob>> given_;
  std::unique_ptr<MappedArray<PairAnswer>> results_on_host_;
  DeviceArray<PairView> pairs_on_device_;
  DeviceArray<PairJob> jobs_;
  DeviceArray<PairAnswer> results_;
  DeviceArray<unsigned> next_;
};

}  // namespace
}  // namespace vpm::cuda

namespace vpm {

std::unique_ptr<DevicePairs> make_device_pairs(const Device& device,
                                               std::span<const SurfaceView> surfaces) {
  const cuda::CurrentDevice current(device.first());
  return std::make_unique<cuda::PairsOnDevice>(device.first(), surfaces);
}

}  // namespace vpm
