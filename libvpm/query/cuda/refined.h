// The refined measure by a team of threads: the same functions, and so the same bits, as
// libvpm/query/measure_refined.cpp.
//
// 1. Units (blocks of shares) are classified by a thread each. What may count is listed and
//    measured by a few threads together; also what only the flood will decide, since most of it is
//    inside.
// 2. Shares that the flood may pass are joined where the graph has an edge, and with the entry
//    where a cut share lets the flood in.
// 3. What is joined with the entry is inside, and is added up.
// The team meets between these steps. Where another surface may hide something, which is rare, it
// meets more often.
#pragma once

#include "libvpm/query/cuda/points.h"
#include "libvpm/query/cuda/team.h"
#include "libvpm/query/cuda/union_find.h"
#include "libvpm/query/cuda/views.h"
#include "libvpm/query/passage.h"

namespace vpm::cuda {

// What is known of a share. A divided share that is `mixed` is resolved by its sums once all its
// units are measured.
enum ShareKind : std::uint8_t { kFree, kCut, kPartial, kWhole, kMixed };
inline constexpr std::uint8_t kKindMask = 0x07;
inline constexpr std::uint8_t kHidden = 0x10;  // by a surface that may be another one
inline constexpr std::uint8_t kUnsure = 0x20;  // a piece of it needs the nearest cut share's plane
inline constexpr std::uint8_t kNear = 0x40;    // its gap has not been read: it is small

__device__ inline bool is_whole(std::uint8_t kind) {
  return (kind & kKindMask) == kWhole;
}
__device__ inline bool may_be_inside(std::uint8_t kind) {
  return is_whole(kind) || (kind & kKindMask) == kPartial;
}
__device__ inline bool is_passable(std::uint8_t kind) {
  return may_be_inside(kind) && (kind & kHidden) == 0;
}

// What is known of measured shares. Of divided ones it is 0 at the start of a query, since many add
// to it.
struct MeasuredShares {
  ToolSum* sums = nullptr;
  ContactPlane* planes = nullptr;  // of cut shares
  unsigned* marks = nullptr;       // of divided shares: kHidden (pieces of it), kUnsure

  __device__ void clear(std::uint32_t i) const {
    sums[i] = ToolSum{};
    planes[i] = ContactPlane{};
    marks[i] = 0;
  }
};

// The plane that crosses a flat block.
struct FlatLook {
  TangentPlane tangent;
  Vec3 center;  // of the block
};

// Memory of one query.
struct RefinedSpace {
  std::uint8_t* kinds = nullptr;     // of each share
  double* gaps = nullptr;            // squared_gap of shares that may be inside
  MeasuredShares measured[2];        // of this query and, cleared by it, of the next: by turns
  std::uint32_t* parents = nullptr;  // count + 1: the entry, then shares
  SphereState* states = nullptr;
  std::uint32_t* cut = nullptr;  // the cut shares
  FlatLook* flats = nullptr;     // of listed units that are flat
  // By parts of the team: units to be measured by many threads, by a few, by one thread each;
  // shares that are not free.
  std::uint32_t* many = nullptr;
  std::uint32_t* few = nullptr;
  std::uint32_t* pieces = nullptr;
  std::uint32_t* shares = nullptr;
};

// Counters of a team; 0 at the start.
struct RefinedCounters {
  unsigned hidden = 0;  // > 0: the flood may pass some share only if the nearest cut one lets it
  unsigned hidden_pieces = 0;  // > 0: some divided share has pieces for the second pass
  unsigned cut = 0;
};

// Most samples of a block for the second of those lists, and the threads for each block of a list:
// more, where there is little to do.
inline constexpr unsigned kFewSamples = 16;
struct Widths {
  unsigned least, most;
};
inline constexpr Widths kForMany{8, 32}, kForFew{4, 16};

template <class Surface, class Team>
class RefinedQuery {
 public:
  __device__ RefinedQuery(const LevelView& level, const Surface& surface, const PoseFrame& frame,
                          const RefinedSpace& space, unsigned turn, RefinedCounters& counters,
                          Team& team)
      : level_(level),
        surface_(surface),
        frame_(frame),
        space_(space),
        measured_(space.measured[turn % 2]),
        next_(space.measured[(turn + 1) % 2]),
        counters_(counters),
        team_(team),
        share_(team.spheres()),
        flood_(space.parents) {}

  // Whether a sphere's points are counted: only spheres that the surface may pass have any.
  __device__ static bool counts_points(const LevelView& level, const Surface& surface,
                                       const PoseFrame& frame, std::uint32_t i) {
    const auto is_mixed = [&](Vec3 at, double radius) {
      return surface.side_of_ball(frame.to_surface * at, radius) == Side::mixed;
    };
    const ShareCluster& cluster = level.clusters[level.cluster_of[i]];
    return is_mixed(cluster.center, cluster.reach) && is_mixed(level.centers[i], level.reach[i]) &&
           is_mixed(level.centers[i], level.spheres[i].radius);
  }

  // This thread's part of the result's sum and counts; `points` apart. Blocks without spheres need
  // not call it.
  __device__ RawResult run() {
    list_work();
    measure_work();
    team_.sync();
    const bool pieces = read(counters_.hidden_pieces) > 0;
    const bool waits = read(counters_.hidden) > 0 || (pieces && any_waits_for_hidden());
    if (pieces) measure_hidden();
    if (waits) decide_hidden();
    join_shares(waits);
    team_.sync();
    return add_up_shares();
  }

 private:
  using Measure = CellMeasure<Surface>;
  // Where this block's rows begin in a list dealt out as part, part + parts, ...
  __device__ std::uint32_t first_of(std::uint32_t count) const {
    return share_.part * (count / share_.parts) + min(share_.part, count % share_.parts);
  }
  // This block's part of a list.
  __device__ std::uint32_t* mine(std::uint32_t* list) const {
    return list + first_of(level_.unit_count);
  }
  __device__ static unsigned read(const unsigned& counter) {
    return *const_cast<const volatile unsigned*>(&counter);
  }
  __device__ Vec3 center(std::uint32_t i) const { return frame_.to_surface * level_.centers[i]; }
  __device__ CutShare cut_share(std::uint32_t cut) const {
    return {measured_.planes[cut], center(cut), level_.reach[cut]};
  }
  __device__ Measure measure_of(const CellView& view) const {
    return {surface_, frame_.to_surface, level_.tool_reach, view};
  }
  __device__ bool is_compact_share(std::uint32_t i) const {
    return is_compact(level_.reach[i], level_.tool_reach);
  }
  __device__ std::uint8_t kind_of(std::uint32_t i) const;

  __device__ void list_work();
  // How a unit is measured, noted in the lists.
  enum class Form : std::uint32_t { flat, sampled, piece, whole };
  static constexpr unsigned kFormBits = 2;
  __device__ static std::uint32_t item(std::uint32_t unit, Form form) {
    return unit << kFormBits | static_cast<std::uint32_t>(form);
  }
  __device__ static Form form_of(std::uint32_t item) {
    return static_cast<Form>(item & ((1U << kFormBits) - 1));
  }

  // What add_pieces() has left: pieces for the second pass; results in other threads than the
  // first.
  struct BlockPart {
    bool hidden = false, is_shared = false;
  };
  struct Listed {
    unsigned many, few, pieces, shares;
  };
  __device__ void list_unit(std::uint32_t index, Listed& listed);
  __device__ void measure_work();
  __device__ bool list_block(std::uint32_t index, const Unit& unit, Listed& listed);
  __device__ void measure_list(const std::uint32_t* list, unsigned count, Widths widths,
                               bool from_the_end);
  __device__ __noinline__ void measure_mixed(Tile tile, std::uint32_t index, Form form);
  __device__ void measure_whole(const Unit& unit);
  __device__ __noinline__ BlockPart add_pieces(Tile tile, const Measure& measure,
                                               const CellView& view, std::uint32_t block,
                                               bool sampled, typename Measure::Pass pass,
                                               CellResult& result) const;
  __device__ void add_flat(const Tile& tile, const Measure& measure, const CellView& view,
                           std::uint32_t block, const FlatLook& flat, CellResult& result) const;
  __device__ __noinline__ bool add_reached(const Measure& measure, const SharePiece& piece,
                                           const CutShare* nearest, ToolSum& sum) const;
  __device__ std::uint8_t read_gap(std::uint32_t sphere) const;
  __device__ bool any_waits_for_hidden() const;
  __device__ void measure_hidden();
  __device__ void decide_hidden();
  __device__ void list_cut();
  __device__ std::uint32_t nearest_cut(const Tile& tile, std::uint32_t sphere) const;
  __device__ void join_shares(bool cut_is_listed);
  __device__ void join(std::uint32_t sphere, std::uint8_t kind, std::uint32_t neighbor,
                       std::uint8_t its_kind) const;
  __device__ void enter(std::uint32_t cut, std::uint32_t sphere, std::uint8_t kind) const;
  __device__ RawResult add_up_shares() const;
  __device__ ToolSum sum_of_share(const Tile& warp, std::uint32_t sphere, std::uint8_t kind) const;
  __device__ bool is_inside(std::uint32_t sphere, std::uint8_t kind) const {
    return is_passable(kind) && flood_.root(sphere + 1) == 0;
  }

  const LevelView& level_;
  const Surface& surface_;
  const PoseFrame& frame_;
  const RefinedSpace& space_;
  const MeasuredShares &measured_, &next_;
  RefinedCounters& counters_;
  Team& team_;
  Share share_;
  UnionFind flood_;  // node 0 is the entry, node i + 1 share i
  Listed listed_{};  // of this block
};

__device__ inline void add_atomically(const ToolSum& part, ToolSum& sum) {
  const auto add = [](const std::int64_t& term, std::int64_t& total) {
    if (term != 0)
      atomicAdd(reinterpret_cast<unsigned long long*>(&total),
                static_cast<unsigned long long>(term));
  };
  add(part.volume.value, sum.volume.value);
  for (int k = 0; k < 3; ++k) {
    add(part.force[k].value, sum.force[k].value);
    add(part.torque[k].value, sum.torque[k].value);
  }
}

__device__ inline void add_atomically(const ContactPlane& part, ContactPlane& plane) {
  const auto add = [](const std::int64_t& term, std::int64_t& total) {
    atomicAdd(reinterpret_cast<unsigned long long*>(&total), static_cast<unsigned long long>(term));
  };
  if (part.count == 0) return;
  for (int k = 0; k < 3; ++k) {
    add(part.normal[k].value, plane.normal[k].value);
    add(part.foot[k].value, plane.foot[k].value);
  }
  add(part.count, plane.count);
}

template <class Surface, class Team>
__device__ std::uint8_t RefinedQuery<Surface, Team>::kind_of(std::uint32_t i) const {
  const std::uint8_t kind = space_.kinds[i];
  if ((kind & kKindMask) != kMixed) return kind;
  if (measured_.planes[i].count > 0) return kCut;
  return measured_.sums[i].volume.value > 0 ? kPartial | (kind & kHidden) : kFree;
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::list_work() {
  __shared__ Listed listed;
  __syncthreads();
  if (threadIdx.x == 0) {
    listed = Listed{};
    if (share_.part == 0) flood_.reset(0);
  }
  __syncthreads();
  for (std::uint32_t u = share_.part + threadIdx.x * share_.parts; u < level_.unit_count;
       u += blockDim.x * share_.parts)
    list_unit(u, listed);
  __syncthreads();
  listed_ = listed;
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::list_unit(std::uint32_t index, Listed& listed) {
  const Unit unit = level_.units[index];
  const std::uint32_t i = unit.share;
  const ShareCluster& cluster = level_.clusters[level_.cluster_of[i]];
  const Vec3 at = frame_.to_surface * cluster.center;
  const auto look = surface_.look_at_ball(at, cluster.reach);
  const Side side =
      look.side == Side::mixed ? surface_.side_of_ball(center(i), level_.reach[i]) : look.side;
  std::uint8_t kind = side == Side::free ? kFree : side == Side::mixed ? kMixed : kWhole;
  if (side == Side::uncut) {
    const Reading reading = surface_.read(center(i));
    if (!(reading.known && reading.distance < 0)) kind = kFree;
  }
  if (kind == kWhole && look.side == Side::behind &&
      surface_.largest_gap(look, at, cluster.reach) < level_.tool_reach)
    kind |= kNear;
  const bool head = level_.is_head(unit), divided = level_.is_divided(i);
  if (kind == kMixed && !list_block(index, unit, listed) && !divided) kind = kFree;
  if (head) {
    if (kind == kWhole || (kind == kMixed && divided)) kind |= read_gap(i);
    space_.kinds[i] = kind;
    space_.states[i] = SphereState::outside;
    if (divided) next_.clear(i);
    if (kind != kFree) {
      flood_.reset(i + 1);
      mine(space_.shares)[atomicAdd(&listed.shares, 1U)] = i;
    }
  }
  const bool counts = is_compact_share(i) ? head : head || unit.block != Unit::kNoBlock;
  if (is_whole(kind) && counts)
    mine(space_.pieces)[atomicAdd(&listed.pieces, 1U)] = item(index, Form::whole);
}

// Lists a unit of a mixed share. Returns whether there is anything to measure.
template <class Surface, class Team>
__device__ bool RefinedQuery<Surface, Team>::list_block(std::uint32_t index, const Unit& unit,
                                                        Listed& listed) {
  if (unit.block == Unit::kNoBlock) return false;
  const CellView view = level_.cell(unit.share);
  const CellBlock block = view.blocks[unit.block];
  const typename Measure::BlockLook look = measure_of(view).look_at(block);
  if (look.side == Side::free) return false;
  if (look.side != Side::mixed) {
    mine(space_.pieces)[atomicAdd(&listed.pieces, 1U)] = item(index, Form::piece);
    return true;
  }
  if (look.is_flat) space_.flats[index] = {look.tangent, look.center};
  const std::uint32_t listing = item(index, look.is_flat ? Form::flat : Form::sampled);
  if (block.end - block.begin > kFewSamples)
    mine(space_.many)[atomicAdd(&listed.many, 1U)] = listing;
  else
    mine(space_.few)[atomicAdd(&listed.few, 1U)] = listing;
  return true;
}

// The gap of a share's centre; returns kHidden, or 0.
template <class Surface, class Team>
__device__ std::uint8_t RefinedQuery<Surface, Team>::read_gap(std::uint32_t i) const {
  const Vec3 at = center(i);
  const double gap = squared_gap(at, surface_.read(at));
  space_.gaps[i] = gap;
  if (!is_hidden_share(gap, level_.tool_reach)) return 0;
  atomicAdd(&counters_.hidden, 1U);
  return kHidden;
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_work() {
  measure_list(mine(space_.many), listed_.many, kForMany, false);
  // From the other end, so that warps without the first kind begin with these.
  measure_list(mine(space_.few), listed_.few, kForFew, true);
  for (std::uint32_t k = blockDim.x - 1 - threadIdx.x; k < listed_.pieces; k += blockDim.x) {
    const std::uint32_t listing = mine(space_.pieces)[k];
    if (form_of(listing) == Form::whole)
      measure_whole(level_.units[listing >> kFormBits]);
    else
      measure_mixed(Tile(1), listing >> kFormBits, Form::piece);
  }
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_list(const std::uint32_t* list, unsigned count,
                                                          Widths widths, bool from_the_end) {
  unsigned width = widths.most;
  while (width > widths.least && count * width > blockDim.x) width /= 2;
  const Tile tile(width);
  const unsigned first = from_the_end ? tile.count() - 1 - tile.index() : tile.index();
  for (unsigned k = first; k < count; k += tile.count())
    measure_mixed(tile, list[k] >> kFormBits, form_of(list[k]));
}

// What one block that is not flat contributes to CellMeasure::run(): its samples, or all of it as
// one piece.
template <class Surface, class Team>
__device__ __noinline__ typename RefinedQuery<Surface, Team>::BlockPart
RefinedQuery<Surface, Team>::add_pieces(Tile tile, const Measure& measure, const CellView& view,
                                        std::uint32_t b, bool sampled, typename Measure::Pass pass,
                                        CellResult& result) const {
  const std::uint32_t begin = sampled ? view.blocks[b].begin : 0;
  const std::uint32_t count = sampled ? view.blocks[b].end - begin : 1;
  bool hidden = false;
  for (std::uint32_t s = tile.lane; s < count; s += tile.width) {
    const SharePiece piece = sampled ? piece_of(view.samples[begin + s]) : piece_of(view.masses[b]);
    hidden |= measure.add_piece(piece, pass, result);
  }
  return {tile.any(hidden), sampled};
}

// The weights of the samples by all threads, their sums in the samples' order by four.
template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::add_flat(const Tile& tile, const Measure& measure,
                                                      const CellView& view, std::uint32_t b,
                                                      const FlatLook& flat,
                                                      CellResult& result) const {
  typename Measure::BlockLook look;
  look.tangent = flat.tangent;
  look.center = flat.center;
  const CellBlock block = view.blocks[b];
  __shared__ double terms[4][kThreads];
  const typename Measure::FlatCut cut = measure.flat_cut(look);
  const unsigned slot = tile.index() * tile.width;
  bool is_cut = false;
  double sum = 0;  // of this thread's row of terms
  for (std::uint32_t begin = block.begin; begin < block.end; begin += tile.width) {
    const std::uint32_t s = begin + tile.lane;
    const double inside = s < block.end ? measure.weight_inside(view.samples[s], cut, is_cut) : 0;
    const Vec3 moment = inside != 0 ? inside * widen(view.samples[s].center) : Vec3{};
    terms[0][slot + tile.lane] = inside;
    terms[1][slot + tile.lane] = moment.x;
    terms[2][slot + tile.lane] = moment.y;
    terms[3][slot + tile.lane] = moment.z;
    __syncwarp(tile.mask);
    const unsigned count = min(tile.width, block.end - begin);
    if (tile.lane < 4)
      for (unsigned k = 0; k < count; ++k) sum += terms[tile.lane][slot + k];
    __syncwarp(tile.mask);
  }
  is_cut = tile.any(is_cut);
  const double sums[4] = {tile.from(sum, 0), tile.from(sum, 1), tile.from(sum, 2),
                          tile.from(sum, 3)};
  if (tile.leads()) measure.add_flat(look, sums[0], {sums[1], sums[2], sums[3]}, is_cut, result);
}

template <class Surface, class Team>
__device__ __noinline__ void RefinedQuery<Surface, Team>::measure_mixed(Tile tile,
                                                                        std::uint32_t index,
                                                                        Form form) {
  const Unit unit = level_.units[index];
  const std::uint32_t i = unit.share;
  const CellView view = level_.cell(i);
  const Measure measure = measure_of(view);
  CellResult result;
  const bool sampled = form == Form::sampled;
  BlockPart part;
  if (form == Form::flat)
    add_flat(tile, measure, view, unit.block, space_.flats[index], result);
  else
    part = add_pieces(tile, measure, view, unit.block, sampled, Measure::Pass::seen, result);
  const bool far = tile.any(result.is_far);
  if (part.is_shared) tile.add_up(result.plane);
  if (level_.is_divided(i)) {
    if (part.is_shared) tile.add_up(result.sum);
    if (!tile.leads()) return;
    add_atomically(result.sum, measured_.sums[i]);
    add_atomically(result.plane, measured_.planes[i]);
    const unsigned marks = (part.hidden ? kHidden : 0U) | (far ? kUnsure : 0U);
    if (marks != 0) atomicOr(&measured_.marks[i], marks);
    if (part.hidden) atomicAdd(&counters_.hidden_pieces, 1U);
    return;
  }
  if (part.hidden)
    add_pieces(tile, measure, view, unit.block, sampled, Measure::Pass::hidden, result);
  if (part.is_shared) tile.add_up(result.sum);
  if (!tile.leads()) return;
  const bool counts = result.sum.volume.value > 0;
  std::uint8_t kind = result.plane.count > 0 ? kCut : counts ? kPartial : kFree;
  if (kind == kPartial) kind |= static_cast<std::uint8_t>(read_gap(i) | (far ? kUnsure : 0));
  space_.kinds[i] = kind;
  measured_.sums[i] = result.sum;
  measured_.planes[i] = result.plane;
}

// What one piece contributes to CellMeasure::reached(). Returns whether that needs the nearest cut
// share and none is given.
template <class Surface, class Team>
__device__ __noinline__ bool RefinedQuery<Surface, Team>::add_reached(const Measure& measure,
                                                                      const SharePiece& piece,
                                                                      const CutShare* nearest,
                                                                      ToolSum& sum) const {
  bool unsure = false;
  const auto cut = [&] {
    unsure = nearest == nullptr;
    return unsure ? CutShare{} : *nearest;
  };
  measure.add_reached(cut, piece, sum);
  return unsure;
}

// A share behind the surface, as if the flood reached it: by its mass, or block by block.
template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_whole(const Unit& unit) {
  const std::uint32_t i = unit.share;
  const bool compact = is_compact_share(i);
  ToolSum sum;
  bool unsure = false;
  if (compact || unit.block != Unit::kNoBlock) {
    const BlockMass& mass = compact ? level_.share_masses[i] : level_.block_masses[unit.block];
    unsure = add_reached(measure_of(level_.cell(i)), piece_of(mass), nullptr, sum);
  }
  if (!compact && level_.is_divided(i)) {
    add_atomically(sum, measured_.sums[i]);
    if (unsure) atomicOr(&measured_.marks[i], unsigned{kUnsure});
  } else {
    measured_.sums[i] = sum;
    if (unsure) space_.kinds[i] |= kUnsure;
  }
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::list_cut() {
  for (std::uint32_t k = threadIdx.x; k < listed_.shares; k += blockDim.x) {
    const std::uint32_t i = mine(space_.shares)[k];
    if (kind_of(i) == kCut) space_.cut[atomicAdd(&counters_.cut, 1U)] = i;
  }
}

// Ties go to the smaller index. level_.count where nothing is cut.
template <class Surface, class Team>
__device__ std::uint32_t RefinedQuery<Surface, Team>::nearest_cut(const Tile& tile,
                                                                  std::uint32_t i) const {
  const Vec3 from = level_.spheres[i].center;
  double best_squared = HUGE_VAL;
  std::uint32_t best = level_.count;
  const auto take = [&](double squared, std::uint32_t j) {
    if (squared > best_squared || (squared == best_squared && j >= best)) return;
    best_squared = squared;
    best = j;
  };
  const unsigned count = read(counters_.cut);
  for (unsigned k = tile.lane; k < count; k += tile.width) {
    const std::uint32_t j = space_.cut[k];
    take(squared_norm(level_.spheres[j].center - from), j);
  }
  for (unsigned other = tile.width / 2; other > 0; other /= 2) {
    const double squared = __shfl_xor_sync(tile.mask, best_squared, other, tile.width);
    take(squared, __shfl_xor_sync(tile.mask, best, other, tile.width));
  }
  return best;
}

// Whether the kind of a divided share depends on its hidden pieces: if nothing else of it is cut.
template <class Surface, class Team>
__device__ bool RefinedQuery<Surface, Team>::any_waits_for_hidden() const {
  bool waits = false;
  for (std::uint32_t k = threadIdx.x; k < level_.divided_count; k += blockDim.x) {
    const std::uint32_t i = level_.divided[k];
    waits |= (measured_.marks[i] & kHidden) != 0 && measured_.planes[i].count == 0;
  }
  return __syncthreads_or(waits) != 0;
}

// The hidden pieces of divided shares, whose planes are known now.
template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::measure_hidden() {
  const Tile warp(32);
  const std::uint32_t count = listed_.many + listed_.few + listed_.pieces;
  for (std::uint32_t k = warp.index(); k < count; k += warp.count()) {
    const std::uint32_t listing = k < listed_.many ? mine(space_.many)[k]
                                  : k < listed_.many + listed_.few
                                      ? mine(space_.few)[k - listed_.many]
                                      : mine(space_.pieces)[k - listed_.many - listed_.few];
    const Form form = form_of(listing);
    if (form == Form::flat || form == Form::whole) continue;
    const Unit unit = level_.units[listing >> kFormBits];
    const std::uint32_t i = unit.share;
    if (!level_.is_divided(i) || (measured_.marks[i] & kHidden) == 0) continue;
    const CellView view = level_.cell(i);
    CellResult result;
    result.plane = measured_.planes[i];
    add_pieces(warp, measure_of(view), view, unit.block, form == Form::sampled,
               Measure::Pass::hidden, result);
    warp.add_up(result.sum);
    if (warp.leads()) add_atomically(result.sum, measured_.sums[i]);
  }
}

// Of the shares that another surface may hide, those before the nearest cut share's plane are
// closed to the flood.
template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::decide_hidden() {
  team_.sync();
  list_cut();
  team_.sync();
  const Tile warp(32);
  for (std::uint32_t k = warp.index(); k < listed_.shares; k += warp.count()) {
    const std::uint32_t i = mine(space_.shares)[k];
    const std::uint8_t kind = kind_of(i);
    if (!may_be_inside(kind) || (kind & kHidden) == 0) continue;
    const std::uint32_t cut = nearest_cut(warp, i);
    if (cut < level_.count && warp.leads() && cut_share(cut).height(center(i)) < 0)
      space_.kinds[i] &= static_cast<std::uint8_t>(~kHidden);
  }
  team_.sync();
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::join_shares(bool cut_is_listed) {
  if (!cut_is_listed) list_cut();
  // An edge belongs to its smaller sphere: large ones have thousands of neighbours.
  constexpr unsigned kLanesPerRow = 8;
  const Tile tile(kLanesPerRow);
  for (std::uint32_t k = tile.index(); k < listed_.shares; k += tile.count()) {
    const std::uint32_t i = mine(space_.shares)[k];
    const std::uint8_t kind = kind_of(i);
    if (kind != kCut && !is_passable(kind)) continue;
    for (std::uint32_t e = level_.edge_begin[i] + tile.lane; e < level_.edge_begin[i + 1];
         e += tile.width) {
      const std::uint32_t j = level_.neighbors[e];
      if (j > i) break;
      join(i, kind, j, kind_of(j));
    }
  }
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::join(std::uint32_t i, std::uint8_t kind,
                                                  std::uint32_t j, std::uint8_t other) const {
  if (is_passable(kind) && is_passable(other))
    flood_.join(i + 1, j + 1);
  else if (kind == kCut && is_passable(other))
    enter(i, j, other);
  else if (other == kCut && is_passable(kind))
    enter(j, i, kind);
}

template <class Surface, class Team>
__device__ void RefinedQuery<Surface, Team>::enter(std::uint32_t cut, std::uint32_t i,
                                                   std::uint8_t kind) const {
  const Vec3 at = center(i);
  const double gap = (kind & kNear) != 0 ? squared_gap(at, surface_.read(at)) : space_.gaps[i];
  if (lies_near_sheet(gap, level_.reach[cut], level_.reach[i]) || cut_share(cut).height(at) < 0)
    flood_.join(0, i + 1);
}

template <class Surface, class Team>
__device__ RawResult RefinedQuery<Surface, Team>::add_up_shares() const {
  RawResult result;
  const Tile warp(32);
  for (std::uint32_t first = warp.index() * 32; first < listed_.shares; first += blockDim.x) {
    const std::uint32_t k = first + warp.lane;
    const std::uint32_t i = k < listed_.shares ? mine(space_.shares)[k] : 0;
    const std::uint8_t kind = k < listed_.shares ? kind_of(i) : kFree;
    const bool inside = is_inside(i, kind);
    const bool unsure = inside && ((kind & kUnsure) != 0 ||
                                   (level_.is_divided(i) && (measured_.marks[i] & kUnsure) != 0));
    ToolSum sum;
    if (kind == kCut || inside) sum = measured_.sums[i];
    for (unsigned rest = __ballot_sync(warp.mask, unsure); rest != 0; rest &= rest - 1) {
      const auto lane = static_cast<unsigned>(__ffs(static_cast<int>(rest)) - 1);
      const ToolSum all =
          sum_of_share(warp, static_cast<std::uint32_t>(warp.from(static_cast<int>(i), lane)),
                       static_cast<std::uint8_t>(warp.from(kind, lane)));
      if (warp.lane == lane) sum = all;
    }
    if (kind != kCut && sum.volume.value == 0) continue;  // the flood passed through the hidden
    space_.states[i] = kind == kCut ? SphereState::boundary : SphereState::inside;
    result.sum.add(sum);
    ++(kind == kCut ? result.boundary : result.inside);
  }
  return result;
}

// An inside share of which pieces are far behind the surface: the nearest cut share vouches for
// them, or they do not count.
template <class Surface, class Team>
__device__ ToolSum RefinedQuery<Surface, Team>::sum_of_share(const Tile& warp, std::uint32_t i,
                                                             std::uint8_t kind) const {
  const CutShare cut = cut_share(nearest_cut(warp, i));
  const CellView view = level_.cell(i);
  const Measure measure = measure_of(view);
  const bool compact = is_whole(kind) && is_compact_share(i);
  ToolSum sum;
  if (compact && warp.leads()) add_reached(measure, piece_of(level_.share_masses[i]), &cut, sum);
  for (std::uint32_t b = view.begin; b < view.end && !compact; ++b) {
    const CellBlock block = view.blocks[b];
    const Side side = is_whole(kind) ? Side::behind : measure.side_of(block);
    if (side == Side::free) continue;
    const bool sampled = side == Side::mixed;
    const std::uint32_t count = sampled ? block.end - block.begin : 1;
    for (std::uint32_t s = warp.lane; s < count; s += warp.width) {
      add_reached(measure,
                  sampled ? piece_of(view.samples[block.begin + s]) : piece_of(view.masses[b]),
                  &cut, sum);
    }
  }
  warp.add_up(sum);
  return sum;
}

}  // namespace vpm::cuda
