// Measures one pair of surfaces at a pose by one block of threads, as SurfacePair does: what
// decides or is summed is the same text, and only who does what when differs.
#pragma once

#include <cuda_runtime.h>

#include "libvpm/device/cuda/runtime.h"
#include "libvpm/device/cuda/team.h"
#include "libvpm/solid/crossed_triangle.h"
#include "libvpm/solid/device_pairs.h"

namespace vpm::cuda {

struct PairView {
  SurfaceView surface[2];
  double per_unit = 1;        // 1/m: what is summed is in the pair's unit
  bool by_triangles = false;  // of the second surface, as outgrows() tells
};

// Segment that two triangles share, in the pair's unit. Each end lies on an edge of one of them:
// 3 role + edge.
struct SharedSegment {
  Vec3 start, end;
  std::uint32_t start_edge, end_edge;
  std::uint32_t next[2];  // of the same triangle of each surface: place from 1 on; 0: none
};

// Memory of a block on the device.
struct PairRoom {
  // Place of a segment of each triangle, from 1 on, the second's behind the first's; 0: none, as
  // between poses.
  std::uint32_t* last_segment;
  SharedSegment* segments;
  std::uint32_t* crossed[2];  // triangles
  std::uint32_t capacity;     // of the three lists
};

// Children of two nodes, bit 4 k + l of `children` for a's l and b's k.
struct NodePair {
  std::uint32_t a, b, children;
};

// How much of a pose has been found. 0 between poses, if several blocks share it.
struct PairCounts {
  unsigned segments, crossed[2], undecided, lacks_room;
  unsigned come;  // blocks that have walked
};

// What the threads of a block share, at the beginning of its dynamic memory.
struct PairState {
  Pose to_other[2];         // from a surface's own frame to the other's
  FloatPose from_other[2];  // back, for bounds
  unsigned pushed[2], listed, asked;
  PairCounts counts;
};

// Sizes of the lists in a block's shared memory. They grow with the block, whose steps take more.
template <unsigned kThreads>
struct PairLists {
  static constexpr unsigned kLanes = 16;  // for a pair of nodes: one for each pair of children
  static constexpr unsigned kGroups = kThreads / kLanes;
  static constexpr unsigned kStack = 96 * kGroups;   // pairs of nodes
  static constexpr unsigned kListed = 6 * kThreads;  // pairs of triangles; nodes, and whole pieces
  static constexpr unsigned kTile = 32 * PairAnswer::kNumbers;  // terms of the lanes of a warp

  static constexpr std::size_t kStackBytes =
      std::max(kStack * sizeof(NodePair), kThreads / 32 * kTile * sizeof(double));
  static constexpr std::size_t kFixedBytes =
      (sizeof(PairState) + 15) / 16 * 16 + kStackBytes + kListed * sizeof(uint2);

  VPM_HD static unsigned words(unsigned bits) { return (bits + 31) / 32; }
  // Returns the words of marks of a surface: its nodes that are crossed, and its vertices that are
  // known to be inside, or outside.
  VPM_HD static unsigned words_of(const SurfaceView& surface) {
    return words(surface.node_count) + 2 * words(surface.vertex_count);
  }
  VPM_HD static std::size_t bytes(const PairView& pair) {
    return kFixedBytes + (words_of(pair.surface[0]) + words_of(pair.surface[1])) * 4;
  }
};

// Measures by the threads of a block, which all call its functions. Refers to its arguments. The
// launch gives PairLists<kThreads>::bytes() of dynamic shared memory. A pose is measured in steps:
// walk() finds the segments that triangles share, mark_crossed() what they tell of vertices and
// nodes, add_crossed() and add_whole() sum up both surfaces' parts inside.
template <unsigned kThreads>
class PairMeasure {
  using Lists = PairLists<kThreads>;

 public:
  __device__ PairMeasure(const PairView& pair, const PairRoom& room)
      : pair_(pair), room_(room), state_(*static_cast<PairState*>(dynamic_shared_memory())) {
    char* at = reinterpret_cast<char*>(&state_) + (sizeof(PairState) + 15) / 16 * 16;
    stack_ = reinterpret_cast<NodePair*>(at);
    tile_ = reinterpret_cast<double*>(at) + threadIdx.x / 32 * Lists::kTile;
    listed_ = reinterpret_cast<uint2*>(at + Lists::kStackBytes);
    marks_ = reinterpret_cast<unsigned*>(listed_ + Lists::kListed);
    found_ = &state_.counts;
  }

  // Measures the pair at a pose, which maps the second's frame to the first's. Thread k of the
  // block receives sum k of PairAnswer; what threads from kSums on receive means nothing.
  __device__ double run(const Pose& pose, bool& has_room, unsigned& undecided) {
    start(pose);
    walk({});
    return finish(has_room, undecided);
  }
  // Does a block's part of the walk of a pose. True for the block that comes last: it finishes.
  __device__ bool run_part(const Pose& pose, PairCounts& shared, const BlockRange& part) {
    start(pose);
    found_ = &shared;
    walk(part);
    __syncthreads();
    if (threadIdx.x == 0) {
      atomicAdd(&shared.undecided, state_.counts.undecided);
      atomicOr(&shared.lacks_room, state_.counts.lacks_room);
    }
    if (!is_last_of(shared.come, part.parts)) return false;
    if (threadIdx.x == 0) state_.counts = shared, shared = {};
    return true;
  }
  // Sums up what the walk has found, and returns what run() does.
  __device__ double finish(bool& has_room, unsigned& undecided) {
    __syncthreads();
    mark_crossed();
    __syncthreads();
    note_contradictions();
    add_crossed();
    add_whole();
    __syncthreads();
    const double sum = add_up();
    forget();
    has_room = state_.counts.lacks_room == 0, undecided = state_.counts.undecided;
    return sum;
  }

 private:
  static constexpr std::uint32_t kLeaf = SurfaceView::kLeaf, kNone = SurfaceView::kNone;
  // Set in numbers of nodes and vertices of the second surface, beside kLeaf of triangles.
  static constexpr std::uint32_t kSecond = 0x40000000u;
  enum Mark : unsigned { crossed_node, inside, outside };

  // High and low parts of a sum, as those of WideSum.
  struct Parts {
    double high = 0, low = 0;
  };

  __device__ const SurfaceView& surface(unsigned role) const { return pair_.surface[role]; }

  // --- Marks ---

  // Returns the words of a mark, a bit for each node or vertex.
  __device__ unsigned* marks(unsigned role, Mark mark) const {
    unsigned* words = marks_ + (role == 0 ? 0 : Lists::words_of(surface(0)));
    if (mark == crossed_node) return words;
    words += Lists::words(surface(role).node_count);
    return mark == inside ? words : words + Lists::words(surface(role).vertex_count);
  }
  __device__ bool is_marked(unsigned role, Mark mark, std::uint32_t k) const {
    return (marks(role, mark)[k / 32] >> k % 32 & 1) != 0;
  }
  // Returns whether it was marked before.
  __device__ bool set_mark(unsigned role, Mark mark, std::uint32_t k) const {
    const unsigned bit = 1U << k % 32;
    return (atomicOr(&marks(role, mark)[k / 32], bit) & bit) != 0;
  }

  // Prepares the block's memory for a pose, with the roots on the stack.
  __device__ void start(const Pose& pose) {
    if (threadIdx.x == 0) {
      state_.to_other[0] = inverse(pose), state_.to_other[1] = pose;
      for (unsigned role = 0; role < 2; ++role)
        state_.from_other[role] = FloatPose(state_.to_other[1 - role]);
      state_.pushed[0] = 1, state_.pushed[1] = 0;
      state_.listed = state_.asked = 0;
      state_.counts = {};
      stack_[0] = {0, 0, 0xffff};
    }
    const unsigned words = Lists::words_of(surface(0)) + Lists::words_of(surface(1));
    for (unsigned k = threadIdx.x; k < words; k += kThreads) marks_[k] = 0;
    __syncthreads();
  }

  // Returns the place in a list of what this lane adds, if it adds, of all lanes of the warp.
  __device__ static unsigned place_in(unsigned& count, bool adds) {
    const unsigned all = __ballot_sync(~0U, adds), lane = threadIdx.x % 32;
    unsigned begin = 0;
    if (lane == 0 && all != 0) begin = atomicAdd(&count, __popc(all));
    return __shfl_sync(~0U, begin, 0) + lanes_before(all);
  }
  // Returns how many of these lanes come before this one.
  __device__ static unsigned lanes_before(unsigned lanes) {
    return __popc(lanes & ((1U << threadIdx.x % 32) - 1));
  }

  // --- Pairs of triangles ---

  // Walks both trees down together from the roots: takes the newest pairs of nodes, sixteen lanes
  // for each, puts the pairs of their children that may meet on the stack, and lists those of
  // triangles, which are met whenever the list is nearly full. Blocks that share a pose walk alike
  // until there is enough for all, and then each goes on with its own.
  __device__ void walk(const BlockRange& part) {
    const unsigned lane = threadIdx.x % Lists::kLanes, group = threadIdx.x / Lists::kLanes;
    unsigned stacked = 0;
    bool is_shared = part.parts > 1;
    for (unsigned turn = 0;; turn ^= 1) {
      stacked += state_.pushed[turn];
      if (is_shared && stacked >= Lists::kGroups) {
        stacked = keep_own(stacked, part);
        is_shared = false;
      }
      const unsigned listed = state_.listed;
      const bool lacks_room = state_.counts.lacks_room != 0;
      const unsigned taken = min(stacked, Lists::kGroups);
      NodePair nodes{0, 0, 0};
      if (group < taken) nodes = stack_[stacked - 1 - group];
      __syncthreads();
      if (threadIdx.x == 0) state_.pushed[turn] = 0;
      if (taken == 0 || lacks_room || listed > Lists::kListed - kThreads) {
        if (!is_shared || part.part == 0) meet_listed(listed);
        __syncthreads();
        if (threadIdx.x == 0) state_.listed = 0;
        if (taken == 0 || lacks_room) return;
        __syncthreads();
      }
      stacked -= taken;
      open(nodes, lane, stacked, state_.pushed[turn ^ 1]);
      __syncthreads();
    }
  }
  // Drops from the stack what other blocks have too and will take, and what is listed from all but
  // the first block. Blocks have opened the same nodes up to here, in whatever order.
  __device__ unsigned keep_own(unsigned stacked, const BlockRange& part) {
    static_assert(Lists::kGroups * Lists::kLanes <= kThreads);  // so that each has a thread
    NodePair nodes{0, 0, 0};
    if (threadIdx.x < stacked) nodes = stack_[threadIdx.x];
    const unsigned hash = (nodes.a * 0x9e3779b1U ^ nodes.b * 0x85ebca6bU) + nodes.children;
    const bool is_own = threadIdx.x < stacked && (hash >> 15) % part.parts == part.part;
    __syncthreads();
    if (threadIdx.x == 0 && part.part != 0) state_.listed = 0;
    const unsigned place = place_in(state_.asked, is_own);
    if (is_own) stack_[place] = nodes;
    __syncthreads();
    const unsigned kept = state_.asked;
    __syncthreads();
    if (threadIdx.x == 0) state_.asked = 0;
    return kept;
  }

  // Tests the children of two nodes, a pair in each lane. A node more than twice as large as the
  // other is opened alone.
  __device__ void open(const NodePair& nodes, unsigned lane, unsigned stacked, unsigned& pushed) {
    constexpr float kLarger = 2;
    const unsigned l = lane % 4, k = lane / 4, shift = threadIdx.x % 32 / Lists::kLanes * 16;
    const std::uint32_t at_a = 4 * nodes.a + l, at_b = 4 * nodes.b + k;
    bool meets = (nodes.children >> lane & 1) != 0;
    float size_a = 0, size_b = 0;
    std::uint32_t a = 0, b = 0;
    if (meets) {
      const SurfaceBounds of_a = surface(0).bounds[at_a], of_b = surface(1).bounds[at_b];
      a = surface(0).child[at_a], b = surface(1).child[at_b];
      size_a = of_a.size, size_b = of_b.size;
      meets = may_meet(of_a, of_b, state_.from_other[0]);
    }
    const bool is_pair = meets && size_a + size_b <= 0;
    const bool opens_a = meets && size_a > kLarger * size_b,
               opens_b = meets && size_b > kLarger * size_a;
    const unsigned all_a = __ballot_sync(~0U, opens_a) >> shift & 0xffff,
                   all_b = __ballot_sync(~0U, opens_b) >> shift & 0xffff;
    // The first lane of b's child, and of a's, puts that child with all that it meets on the stack.
    const unsigned with_a = all_a >> l & 0x1111, with_b = all_b >> 4 * k & 15;
    const bool pushes[]{meets && !is_pair && !opens_a && !opens_b,
                        opens_b && (with_b & ((1U << l) - 1)) == 0,
                        opens_a && (with_a & ((1U << 4 * k) - 1)) == 0};
    const NodePair opened[]{
        {a, b, 0xffff}, {nodes.a, b, with_b * 0x1111}, {a, nodes.b, with_a * 15}};
    unsigned lanes[3], count = 0;
    for (unsigned n = 0; n < 3; ++n) count += __popc(lanes[n] = __ballot_sync(~0U, pushes[n]));
    unsigned place = 0;
    if (threadIdx.x % 32 == 0 && count > 0) place = atomicAdd(&pushed, count);
    place = stacked + __shfl_sync(~0U, place, 0);
    for (unsigned n = 0; n < 3; ++n) {
      if (pushes[n]) push(place + lanes_before(lanes[n]), opened[n]);
      place += __popc(lanes[n]);
    }
    const unsigned listed = place_in(state_.listed, is_pair);
    if (is_pair) listed_[listed] = {a & ~kLeaf, b & ~kLeaf};
  }
  __device__ void push(unsigned place, const NodePair& nodes) {
    if (place < Lists::kStack)
      stack_[place] = nodes;
    else
      state_.counts.lacks_room = 1;
  }

  // Returns a triangle in the first's frame.
  __device__ PlacedTriangle placed(unsigned role, std::uint32_t triangle) const {
    const SurfaceView& of = surface(role);
    const Triangle index = of.triangles[triangle];
    std::array<Vec3, 3> corners{of.vertices[index[0]], of.vertices[index[1]],
                                of.vertices[index[2]]};
    if (role == 1)
      for (Vec3& corner : corners) corner = state_.to_other[1] * corner;
    return placed_triangle(corners, of.longest_edge[triangle], index);
  }

  __device__ void meet_listed(unsigned count) {
    for (unsigned k = threadIdx.x; k < count; k += kThreads) meet(listed_[k].x, listed_[k].y);
  }
  // Finds how two triangles meet, and lists the segment that they share.
  __device__ void meet(std::uint32_t first, std::uint32_t second) {
    const PlacedTriangle a = placed(0, first), b = placed(1, second);
    const PairTests<double> tests(a.corner, a.normal, b.corner, b.normal,
                                  a.longest_edge + b.longest_edge);
    const SignBits<unsigned> signs = signs_of<unsigned>(tests);
    if (edges_that_miss(signs) == kAllEdges) return;
    TriangleCrossing crossing;
    const Meeting meeting =
        cross_triangles(a, b, {tests.above_b, tests.above_a, signs.above, signs.below}, crossing);
    if (meeting == Meeting::undecided) atomicAdd(&state_.counts.undecided, 1U);
    if (meeting == Meeting::crossing) add_segment(first, second, crossing);
  }
  __device__ void add_segment(std::uint32_t first, std::uint32_t second,
                              const TriangleCrossing& crossing) {
    const unsigned place = atomicAdd(&found_->segments, 1U);
    if (place >= room_.capacity) {
      state_.counts.lacks_room = 1;
      return;
    }
    SharedSegment& segment = room_.segments[place];
    segment.start = pair_.per_unit * crossing.start, segment.end = pair_.per_unit * crossing.end;
    for (unsigned role = 0; role < 2; ++role) {
      const int count = role == 0 ? crossing.first_count : crossing.second_count;
      const auto& points = role == 0 ? crossing.of_first : crossing.of_second;
      for (int k = 0; k < 2; ++k) {
        if (k >= count) break;
        const EdgeCrossing& at = points[static_cast<std::size_t>(k)];
        const unsigned edge = 3 * role + static_cast<unsigned>(at.edge);
        (at.sign == sign_at_start(role) ? segment.start_edge : segment.end_edge) = edge;
      }
      const std::uint32_t triangle = role == 0 ? first : second;
      segment.next[role] = atomicExch(&last_segment(role, triangle), place + 1);
      if (segment.next[role] == 0)
        room_.crossed[role][atomicAdd(&found_->crossed[role], 1U)] = triangle;
    }
  }
  // Returns the sign of an edge's crossing where a segment starts: it does where an edge of the
  // first leaves the other solid, or one of the second enters.
  __device__ static int sign_at_start(unsigned role) { return role == 0 ? -1 : 1; }
  __device__ std::uint32_t& last_segment(unsigned role, std::uint32_t triangle) const {
    return room_.last_segment[(role == 0 ? 0 : surface(0).triangle_count) + triangle];
  }
  // Calls take(edge, sign, is_start) for the crossings of edges of a triangle at a segment's ends.
  template <class Take>
  __device__ static void for_edges(unsigned role, const SharedSegment& segment, const Take& take) {
    if (segment.start_edge / 3 == role) take(segment.start_edge % 3, sign_at_start(role), true);
    if (segment.end_edge / 3 == role) take(segment.end_edge % 3, -sign_at_start(role), false);
  }

  // --- Crossed triangles ---

  __device__ unsigned crossed_count() const {
    return state_.counts.crossed[0] + state_.counts.crossed[1];
  }
  __device__ unsigned role_of(unsigned k) const { return k < state_.counts.crossed[0] ? 0 : 1; }
  __device__ std::uint32_t crossed(unsigned role, unsigned k) const {
    return room_.crossed[role][k - (role == 0 ? 0 : state_.counts.crossed[0])];
  }

  // Takes the sides of vertices from the crossings of their edges, and marks the nodes above.
  __device__ void mark_crossed() {
    for (unsigned k = threadIdx.x; k < crossed_count(); k += kThreads) {
      const unsigned role = role_of(k);
      const std::uint32_t triangle = crossed(role, k);
      int entries[3]{};
      for (std::uint32_t s = last_segment(role, triangle); s != 0;
           s = room_.segments[s - 1].next[role])
        for_edges(role, room_.segments[s - 1], [&](unsigned edge, int sign, bool) {
          for (unsigned e = 0; e < 3; ++e) entries[e] += e == edge ? sign : 0;
        });
      const Triangle corners = surface(role).triangles[triangle];
      for (unsigned edge = 0; edge < 3; ++edge) {
        if (entries[edge] == 0) continue;
        if (abs(entries[edge]) > 1) atomicAdd(&state_.counts.undecided, 1U);
        const std::uint32_t from = corners[edge], to = corners[(edge + 1) % 3];
        set_mark(role, inside, entries[edge] < 0 ? from : to);
        set_mark(role, outside, entries[edge] < 0 ? to : from);
      }
      for (std::uint32_t node = surface(role).parent_of[triangle];
           !set_mark(role, crossed_node, node);)
        node = surface(role).node_above[node];
    }
  }

  // Counts words of vertices that are told to be on both sides as undecided.
  __device__ void note_contradictions() {
    for (unsigned role = 0; role < 2; ++role)
      for (unsigned k = threadIdx.x; k < Lists::words(surface(role).vertex_count); k += kThreads)
        if ((marks(role, inside)[k] & marks(role, outside)[k]) != 0)
          atomicAdd(&state_.counts.undecided, 1U);
  }

  __device__ bool is_known(unsigned role, std::uint32_t vertex) const {
    return is_marked(role, inside, vertex) || is_marked(role, outside, vertex);
  }

  // Lists a vertex, if it is asked and not known, in the place of the stack. All lanes of a warp
  // call it.
  __device__ void ask(bool asks, unsigned role, std::uint32_t vertex) {
    const bool adds = asks && !is_known(role, vertex);
    const unsigned place = place_in(state_.asked, adds);
    if (!adds) return;
    if (place < kMostAsked)
      asked()[place] = vertex | (role == 0 ? 0 : kSecond);
    else
      state_.counts.lacks_room = 1;
  }
  // Marks the sides of the listed vertices: eight lanes share the triangles of a column.
  __device__ void answer() {
    constexpr unsigned kSharing = 8;
    __syncthreads();
    const unsigned count = min(state_.asked, kMostAsked), lane = threadIdx.x % kSharing;
    for (unsigned first = threadIdx.x / 32 * (32 / kSharing); first < count;
         first += kThreads / kSharing) {
      const unsigned k = first + threadIdx.x % 32 / kSharing;
      const std::uint32_t vertex = k < count ? asked()[k] & ~kSecond : 0;
      const unsigned role = k < count ? asked()[k] / kSecond : 0;
      const InsideView& other = surface(1 - role).inside;
      const Vec3 x = state_.to_other[role] * surface(role).vertices[vertex];
      std::size_t column = 0;
      const InsideView::Cell found = other.state_at(x, column);
      int winding = found == InsideView::Cell::cut ? other.winding(x, column, lane, kSharing) : 0;
      for (int bits = 1; bits < static_cast<int>(kSharing); bits *= 2)
        winding += __shfl_xor_sync(~0U, winding, bits);
      const bool is_in = found == InsideView::Cell::inside || winding > 0;
      if (lane == 0 && k < count) set_mark(role, is_in ? inside : outside, vertex);
    }
    __syncthreads();
    if (threadIdx.x == 0) state_.asked = 0;
    __syncthreads();
  }
  static constexpr unsigned kMostAsked = Lists::kStackBytes / sizeof(std::uint32_t);
  __device__ std::uint32_t* asked() const { return reinterpret_cast<std::uint32_t*>(stack_); }

  __device__ void add_crossed() {
    const unsigned count = crossed_count();
    for (unsigned first = threadIdx.x / 32 * 32; first < count; first += kThreads) {
      const unsigned k = first + threadIdx.x % 32, role = role_of(k);
      ask(k < count, role, k < count ? surface(role).triangles[crossed(role, k)][2] : 0);
    }
    answer();
    for (unsigned first = threadIdx.x / 32 * 32; first < count; first += kThreads) {
      const unsigned k = first + threadIdx.x % 32, role = role_of(k);
      SurfaceMoments moments;
      if (k < count) moments = moments_of_crossed(role, crossed(role, k));
      add(moments, k < count, role, cut_);
    }
  }
  __device__ SurfaceMoments moments_of_crossed(unsigned role, std::uint32_t triangle) const {
    const PlacedTriangle at = placed(role, triangle);
    CrossedTriangleOf<FourNumbers> part;
    const auto& [a, b, c] = at.corner;
    part.set_corners({pair_.per_unit * a, pair_.per_unit * b, pair_.per_unit * c},
                     normalized_or_zero(at.normal));
    for (std::uint32_t s = last_segment(role, triangle); s != 0;) {
      const SharedSegment segment = room_.segments[s - 1];
      part.add_segment(role == 0 ? segment.start : segment.end,
                       role == 0 ? segment.end : segment.start);
      for_edges(role, segment, [&](unsigned edge, int sign, bool is_start) {
        part.add_crossing(edge, sign, is_start ? segment.start : segment.end);
      });
      s = segment.next[role];
    }
    part.add_corners_inside(is_marked(role, inside, at.index[2]));
    return flat_moments(part.normal, part.area(), part.mean(), part.products());
  }

  // --- What is inside as a whole ---

  // Nodes to open and pieces found share the list of pairs, which is free now.
  static constexpr unsigned kHalf = Lists::kListed;  // words of each half

  __device__ void add_whole() {
    std::uint32_t* const nodes = reinterpret_cast<std::uint32_t*>(listed_);
    std::uint32_t* const pieces = nodes + kHalf;
    __syncthreads();
    if (threadIdx.x < 2) nodes[threadIdx.x] = threadIdx.x == 0 ? 0 : kSecond;
    if (threadIdx.x == 0) state_.pushed[0] = 2, state_.pushed[1] = state_.listed = 0;
    __syncthreads();
    unsigned stacked = 0;
    for (unsigned turn = 0;; turn ^= 1) {
      stacked += state_.pushed[turn];
      const unsigned found = state_.listed, taken = min(stacked, kThreads / 4);
      const bool lacks_room = state_.counts.lacks_room != 0, opens = threadIdx.x / 4 < taken;
      const std::uint32_t node = opens ? nodes[stacked - 1 - threadIdx.x / 4] : 0;
      __syncthreads();
      if (threadIdx.x == 0) state_.pushed[turn] = 0;
      if (taken == 0 || lacks_room || found > kHalf - kThreads) {
        add_pieces(pieces, found);
        __syncthreads();
        if (threadIdx.x == 0) state_.listed = 0;
        if (taken == 0 || lacks_room) return;
        __syncthreads();
      }
      stacked -= taken;
      Kind kind = Kind::nothing;
      std::uint32_t child = 0;
      if (opens) kind = look_at(node >> 30 & 1, node & ~kSecond, threadIdx.x % 4, child);
      child |= node & kSecond;
      const unsigned at = stacked + place_in(state_.pushed[turn ^ 1], kind == Kind::node);
      if (kind == Kind::node && at < kHalf) nodes[at] = child;
      if (kind == Kind::node && at >= kHalf) state_.counts.lacks_room = 1;
      const unsigned place = place_in(state_.listed, kind == Kind::piece);
      if (kind == Kind::piece) pieces[place] = child;
      __syncthreads();
    }
  }

  // A child that is far from the other surface or crossed, a node to be opened, or one that is
  // inside or outside as a whole.
  enum class Kind { nothing, node, piece };

  __device__ Kind look_at(unsigned role, std::uint32_t node, unsigned k,
                          std::uint32_t& child) const {
    const SurfaceView& own = surface(role);
    child = own.child[4 * node + k];
    const SurfaceBounds bounds = own.bounds[4 * node + k], all = surface(1 - role).bounds[0];
    if (!may_meet(bounds, all, state_.from_other[role])) return Kind::nothing;
    if ((child & kLeaf) != 0)
      return last_segment(role, child & ~kLeaf) == 0 ? Kind::piece : Kind::nothing;
    const bool is_open =
        own.probe[child] == kNone || is_marked(role, crossed_node, child) || is_by_triangles(role);
    return is_open ? Kind::node : Kind::piece;
  }
  // Returns the vertex that tells for a piece: of a triangle's one whose side is known, if any is.
  __device__ std::uint32_t probe_of(unsigned role, std::uint32_t child) const {
    if ((child & kLeaf) == 0) return surface(role).probe[child];
    const Triangle corners = surface(role).triangles[child & ~kLeaf];
    for (const std::uint32_t v : corners)
      if (is_known(role, v)) return v;
    return corners[0];
  }

  __device__ void add_pieces(const std::uint32_t* pieces, unsigned count) {
    for (unsigned first = threadIdx.x / 32 * 32; first < count; first += kThreads) {
      const unsigned k = first + threadIdx.x % 32;
      const std::uint32_t piece = k < count ? pieces[k] : 0;
      const unsigned role = piece >> 30 & 1;
      ask(k < count, role, probe_of(role, piece & ~kSecond));
    }
    answer();
    for (unsigned first = threadIdx.x / 32 * 32; first < count; first += kThreads) {
      const unsigned k = first + threadIdx.x % 32;
      const std::uint32_t piece = k < count ? pieces[k] : 0;
      const unsigned role = piece >> 30 & 1;
      const bool counts = k < count && is_marked(role, inside, probe_of(role, piece & ~kSecond));
      SurfaceMoments moments;
      if (counts) moments = scaled(moments_of_whole(role, piece & ~kSecond), pair_.per_unit);
      add(moments, counts && !is_by_triangles(role), role, whole_);
      if (pair_.by_triangles) add(moments, counts && role == 1, role, cut_);
    }
  }
  __device__ bool is_by_triangles(unsigned role) const { return role == 1 && pair_.by_triangles; }
  __device__ SurfaceMoments moments_of_whole(unsigned role, std::uint32_t child) const {
    const SurfaceView& own = surface(role);
    if ((child & kLeaf) == 0) return own.moments[child];
    const std::uint32_t triangle = child & ~kLeaf;
    const auto [i, j, k] = own.triangles[triangle];
    std::array<Vec3, 3> at{own.vertices[i], own.vertices[j], own.vertices[k]};
    if (is_by_triangles(role)) at = placed(role, triangle).corner;
    return triangle_moments(at[0], at[1], at[2]);
  }

  // --- Sums ---

  // Adds the lanes' moments to the sums of their roles: each lane adds up one number of one role.
  __device__ void add(const SurfaceMoments& moments, bool counts, unsigned role, Parts& parts) {
    const unsigned lane = threadIdx.x % 32, number = lane % PairAnswer::kNumbers;
    if (counts) *reinterpret_cast<SurfaceMoments*>(tile_ + lane * PairAnswer::kNumbers) = moments;
    const unsigned first = __ballot_sync(~0U, counts && role == 0),
                   second = __ballot_sync(~0U, counts && role == 1);
    unsigned rows = lane < PairAnswer::kNumbers       ? first
                    : lane < 2 * PairAnswer::kNumbers ? second
                                                      : 0;
    __syncwarp();
    for (; rows != 0; rows &= rows - 1)
      WideSum::add(tile_[(__ffs(static_cast<int>(rows)) - 1) * PairAnswer::kNumbers + number],
                   parts.high, parts.low);
    __syncwarp();
  }

  // Adds up the sums of all warps. Returns this thread's number of the answer.
  __device__ double add_up() {
    constexpr unsigned kHalfSums = PairAnswer::kSums / 2;
    const unsigned lane = threadIdx.x % 32;
    Parts* const of_warp = reinterpret_cast<Parts*>(tile_);
    if (lane < kHalfSums) of_warp[lane] = cut_, of_warp[kHalfSums + lane] = whole_;
    __syncthreads();
    Parts sum;
    if (threadIdx.x < PairAnswer::kSums) {
      const char* at = reinterpret_cast<const char*>(stack_);
      for (unsigned warp = 0; warp < kThreads / 32; ++warp, at += Lists::kTile * sizeof(double)) {
        const Parts part = reinterpret_cast<const Parts*>(at)[threadIdx.x];
        sum.high += part.high, sum.low += part.low;
      }
    }
    return sum.high + sum.low;
  }

  // Clears what the next pose needs clear.
  __device__ void forget() {
    for (unsigned k = threadIdx.x; k < crossed_count(); k += kThreads) {
      const unsigned role = role_of(k);
      last_segment(role, crossed(role, k)) = 0;
    }
  }

  const PairView& pair_;
  const PairRoom& room_;
  PairState& state_;
  PairCounts* found_;  // of this block, or of all that share the pose
  NodePair* stack_;
  double* tile_;  // of the warp, in the place of the stack
  uint2* listed_;
  unsigned* marks_;
  Parts cut_, whole_;  // of this lane's number and role
};

}  // namespace vpm::cuda
