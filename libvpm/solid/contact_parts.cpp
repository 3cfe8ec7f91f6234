#include "libvpm/solid/contact_parts.h"

#include <limits>
#include <tuple>

namespace vpm {

ContactParts::ContactParts(const SurfaceTree& first, const SurfaceTree& second)
    : trees_{&first, &second}, slots_(256, kNone) {
  for (std::size_t role = 0; role < 2; ++role) {
    const SurfaceTree& tree = *trees_[role];
    vertex_element_[role].assign(tree.vertices().size(), 0);
    vertex_stamp_[role].assign(tree.vertices().size(), 0);
    triangles_of_[role].assign(tree.vertices().size(), {kNone, 0});
    rim_of_[role].assign(tree.nodes().size(), {kNone, 0});
    for (std::uint32_t t = 0; t < tree.triangles().size(); ++t)
      for (const std::uint32_t v : tree.triangles()[t]) {
        auto& [low, high] = triangles_of_[role][v];
        low = std::min(low, t), high = t;
      }
  }
}

void ContactParts::start() {
  if (++stamp_ == 0) {  // wrapped: forget all stamps
    for (auto& stamps : vertex_stamp_) stamps.assign(stamps.size(), 0);
    stamp_ = 1;
  }
  segments_.clear(), edges_.clear(), crossings_.clear(), parent_.clear();
  slots_.assign(slots_.size(), kNone);
  for (std::size_t role = 0; role < 2; ++role) {
    last_of_face_[role].clear();
    chain_[role].clear(), is_open_[role].clear();
  }
}

void ContactParts::add(std::array<std::uint32_t, 2> face, const TriangleCrossing& crossing,
                       double per_unit) {
  const auto number = static_cast<std::uint32_t>(segments_.size());
  ContactSegment segment{face, {}, per_unit * crossing.start, per_unit * crossing.end, {}};
  std::size_t count = 0;
  const auto note = [&](std::uint32_t role, const EdgeCrossing& at) {
    if (count < 2) segment.ends[count++] = {role, at.edge, at.sign, per_unit * at.place};
  };
  for (int k = 0; k < crossing.first_count; ++k)
    note(0, crossing.of_first[static_cast<std::size_t>(k)]);
  for (int k = 0; k < crossing.second_count; ++k)
    note(1, crossing.of_second[static_cast<std::size_t>(k)]);
  for (std::size_t role = 0; role < 2; ++role) {
    std::vector<std::uint32_t>& last = last_of_face_[role];
    if (last.size() <= face[role]) last.resize(face[role] + 1, kNone);
    segment.next[role] = last[face[role]];
    last[face[role]] = number;
    chain_[role].push_back(number);
    is_open_[role].push_back(0);
  }
  segments_.push_back(segment);
  parent_.push_back(number);
}

std::uint32_t ContactParts::root_of(std::vector<std::uint32_t>& parent, std::uint32_t k) {
  while (parent[k] != k) k = parent[k] = parent[parent[k]];
  return k;
}

std::uint32_t ContactParts::find(std::uint32_t element) {
  return root_of(parent_, element);
}

// Returns the element of a vertex that is inside.
std::uint32_t ContactParts::vertex(std::uint32_t role, std::uint32_t v) {
  if (vertex_stamp_[role][v] != stamp_) {
    vertex_stamp_[role][v] = stamp_;
    vertex_element_[role][v] = static_cast<std::uint32_t>(parent_.size());
    parent_.push_back(vertex_element_[role][v]);
  }
  return vertex_element_[role][v];
}

// Returns the slot that holds an edge, or the empty one where it belongs.
std::size_t ContactParts::slot_of(std::uint32_t role, std::uint32_t low, std::uint32_t high) const {
  std::uint32_t hash = low * 0x9e3779b1u ^ high * 0x85ebca77u ^ role * 0xc2b2ae3du;
  hash ^= hash >> 15;
  std::size_t slot = hash & (slots_.size() - 1);
  for (; slots_[slot] != kNone; slot = (slot + 1) & (slots_.size() - 1)) {
    const Edge& at = edges_[slots_[slot]];
    if (at.role == role && at.low == low && at.high == high) break;
  }
  return slot;
}

// Returns a crossed edge of a surface; null if nothing crosses it.
const ContactParts::Edge* ContactParts::edge(std::uint32_t role, std::uint32_t p,
                                             std::uint32_t q) const {
  const std::uint32_t at = slots_[slot_of(role, std::min(p, q), std::max(p, q))];
  return at == kNone ? nullptr : &edges_[at];
}

void ContactParts::grow() {
  slots_.assign(2 * slots_.size(), kNone);
  for (std::uint32_t k = 0; k < edges_.size(); ++k)
    slots_[slot_of(edges_[k].role, edges_[k].low, edges_[k].high)] = k;
}

void ContactParts::add_crossing(std::uint32_t number, const ContactSegment::End& end) {
  const ContactSegment& segment = segments_[number];
  const std::uint32_t face = segment.face[end.role];
  const CrossedTriangle& triangle = faces_[end.role][face];
  const auto k = static_cast<std::size_t>(end.edge);
  std::uint32_t low = corners(end.role, face)[k], high = corners(end.role, face)[(k + 1) % 3];
  Vec3 from = triangle.corner[k], to = triangle.corner[(k + 1) % 3];
  const bool is_turned = low > high;
  if (is_turned) std::swap(low, high), std::swap(from, to);
  std::size_t slot = slot_of(end.role, low, high);
  if (slots_[slot] == kNone) {
    slots_[slot] = static_cast<std::uint32_t>(edges_.size());
    edges_.push_back({end.role, low, high, kNone, false, false});
    if (2 * edges_.size() > slots_.size()) grow(), slot = slot_of(end.role, low, high);
  }
  Edge& at = edges_[slots_[slot]];
  crossings_.push_back({number, segment.face[1 - end.role], at.last, (end.sign > 0) != is_turned,
                        dot(end.place - from, to - from)});
  at.last = static_cast<std::uint32_t>(crossings_.size() - 1);
}

void ContactParts::join_along_edges(std::array<std::span<const CrossedTriangle>, 2> faces) {
  faces_ = faces;
  for (std::uint32_t k = 0; k < segments_.size(); ++k)
    for (const ContactSegment::End& end : segments_[k].ends)
      if (end.sign != 0) add_crossing(k, end);
  for (Edge& at : edges_) join_along(at);
}

// Fills `sorted_` with the crossings of an edge, from its lower vertex on.
void ContactParts::sort_crossings(const Edge& at) {
  sorted_.clear();
  for (std::uint32_t k = at.last; k != kNone; k = crossings_[k].next)
    sorted_.push_back(&crossings_[k]);
  if (sorted_.size() == 2 && sorted_[0]->face == sorted_[1]->face) return;  // one, as most are
  std::ranges::sort(sorted_, {},
                    [](const Crossing* c) { return std::tuple(c->along, c->face, c->segment); });
}

// Joins the segments that end at the same crossing of an edge, and crossings between which the edge
// is inside the other solid, or inside up to its vertex.
void ContactParts::join_along(Edge& at) {
  sort_crossings(at);
  const std::uint32_t role = at.role;
  at.low_inside = !sorted_.front()->enters;
  at.high_inside = sorted_.back()->enters;
  const bool is_one = sorted_.size() == 2 && sorted_[0]->face == sorted_[1]->face;
  const Crossing* before = nullptr;
  for (const Crossing* c : sorted_) {
    is_open_[role][c->segment] = 1;
    // A face on one side only: the surface has a slit here, by less than is resolved.
    if (!is_one && std::ranges::count(sorted_, c->face, &Crossing::face) < 2)
      is_open_[1 - role][c->segment] = 1;
    if (before == nullptr) {
      if (at.low_inside) join(c->segment, vertex(role, at.low));
    } else if (before->face == c->face) {
      join(c->segment, before->segment);
      std::vector<std::uint32_t>& chain = chain_[1 - role];
      chain[root_of(chain, c->segment)] = root_of(chain, before->segment);
    } else if (!c->enters || before->enters) {
      join(c->segment, before->segment);
    }
    before = c;
  }
  if (at.high_inside) join(before->segment, vertex(role, at.high));
}

// Joins the corners of a face along edges that nothing crosses. `far_inside`: if the third is
// inside.
void ContactParts::join_corners(std::uint32_t role, std::uint32_t face, bool far_inside) {
  const Triangle& v = corners(role, face);
  std::array<const Edge*, 3> at;
  for (std::size_t k = 0; k < 3; ++k) at[k] = edge(role, v[k], v[(k + 1) % 3]);
  const auto side = [&](const Edge* crossed, std::uint32_t corner) {
    return crossed == nullptr       ? far_inside
           : crossed->low == corner ? crossed->low_inside
                                    : crossed->high_inside;
  };
  const std::array<bool, 3> inside{side(at[2], v[0]), side(at[1], v[1]), far_inside};
  unsigned mask = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    mask |= inside[k] ? 1u << k : 0;
    if (at[k] == nullptr && inside[k] && inside[(k + 1) % 3])
      join(vertex(role, v[k]), vertex(role, v[(k + 1) % 3]));
  }
  corners_inside_[role][face] = static_cast<std::uint8_t>(mask);
}

// Joins chains of segments that bound a hole of the part of a face inside with what is around them.
void ContactParts::join_holes(std::uint32_t role) {
  std::vector<std::uint32_t>& chain = chain_[role];
  const auto count = static_cast<std::uint32_t>(segments_.size());
  for (std::uint32_t k = 0; k < count; ++k)
    if (is_open_[role][k] != 0) is_open_[role][root_of(chain, k)] = 1;
  areas_.assign(count, 0);
  extremes_.assign(count, kNone);
  const auto along = [&](std::uint32_t k) {
    const CrossedTriangle& face = faces_[role][segments_[k].face[role]];
    return dot(segments_[k].start, face.corner[1] - face.corner[0]);
  };
  for (std::uint32_t k = 0; k < count; ++k) {
    const std::uint32_t root = root_of(chain, k);
    if (is_open_[role][root] != 0) continue;
    const ContactSegment& segment = segments_[k];
    const Vec3 origin = segments_[root].start;
    const double area = dot(cross(segment.start - origin, segment.end - origin),
                            faces_[role][segment.face[role]].normal);
    areas_[root] += role == 0 ? area : -area;
    if (extremes_[root] == kNone || along(k) > along(extremes_[root])) extremes_[root] = k;
  }
  for (std::uint32_t k = 0; k < count; ++k)
    if (areas_[k] < 0)
      join(k, element_at(role, segments_[k].face[role], segments_[extremes_[k]].start, k));
}

std::uint32_t ContactParts::element_at(std::uint32_t role, std::uint32_t face, Vec3 place,
                                       std::uint32_t chain) {
  const CrossedTriangle& triangle = faces_[role][face];
  const Vec3 ahead = normalized_or_zero(triangle.corner[1] - triangle.corner[0]);
  const Vec3 aside = cross(triangle.normal, ahead);
  double nearest = std::numeric_limits<double>::infinity();
  // Returns true if the ray meets a segment before all others so far.
  const auto meets = [&](Vec3 p, Vec3 q) {
    const double at_p = dot(aside, p - place), at_q = dot(aside, q - place);
    if ((at_p > 0) == (at_q > 0)) return false;
    const double from = dot(ahead, p - place), to = dot(ahead, q - place);
    const double distance = from + at_p / (at_p - at_q) * (to - from);
    if (!(distance > 0) || distance >= nearest) return false;
    nearest = distance;
    return true;
  };
  std::uint32_t met = kNone;
  for (std::uint32_t k = last_of_face_[role][face]; k != kNone; k = segments_[k].next[role])
    if ((chain == kNone || root_of(chain_[role], k) != chain) &&
        meets(segments_[k].start, segments_[k].end))
      met = k;
  for (std::size_t k = 0; k < 3; ++k)
    if (meets(triangle.corner[k], triangle.corner[(k + 1) % 3]))
      met = element_on_edge(role, face, k, place + nearest * ahead);
  return met != kNone ? met : last_of_face_[role][face];
}

// Returns the crossing or vertex that is next to a place on edge k of a face, which is inside.
std::uint32_t ContactParts::element_on_edge(std::uint32_t role, std::uint32_t face, std::size_t k,
                                            Vec3 place) {
  const CrossedTriangle& triangle = faces_[role][face];
  const std::uint32_t p = corners(role, face)[k], q = corners(role, face)[(k + 1) % 3];
  const Edge* at = edge(role, p, q);
  if (at == nullptr) return vertex(role, p);
  const Vec3 low = triangle.corner[p < q ? k : (k + 1) % 3],
             high = triangle.corner[p < q ? (k + 1) % 3 : k];
  const double along = dot(place - low, high - low);
  sort_crossings(*at);
  for (const Crossing* c : sorted_)
    if (c->along >= along && !c->enters) return c->segment;
  for (std::size_t i = sorted_.size(); i-- > 0;)
    if (sorted_[i]->along <= along && sorted_[i]->enters) return sorted_[i]->segment;
  return sorted_.back()->segment;
}

int ContactParts::parts_of_segments() {
  if (segments_.empty()) return 0;
  const std::uint32_t first = find(0);
  for (std::uint32_t k = 1; k < segments_.size(); ++k)
    if (find(k) != first) return 2;
  return 1;
}

std::uint32_t ContactParts::part_of_face(std::uint32_t role, std::uint32_t face) {
  std::uint32_t k = last_of_face_[role][face];
  const std::uint32_t part = find(k);
  while ((k = segments_[k].next[role]) != kNone)
    if (find(k) != part) return kNone;
  return part;
}

std::span<const std::uint32_t> ContactParts::parts_of_face(std::uint32_t role, std::uint32_t face) {
  found_.clear();
  for (std::uint32_t k = last_of_face_[role][face]; k != kNone; k = segments_[k].next[role])
    if (const std::uint32_t part = find(k); std::ranges::find(found_, part) == found_.end())
      found_.push_back(part);
  return found_;
}

CrossedTriangle ContactParts::piece(std::uint32_t role, std::uint32_t face, std::uint32_t part) {
  CrossedTriangle piece;
  piece.set_corners(faces_[role][face].corner, faces_[role][face].normal);
  for (std::uint32_t k = last_of_face_[role][face]; k != kNone; k = segments_[k].next[role]) {
    if (find(k) != part) continue;
    const ContactSegment& s = segments_[k];
    role == 0 ? piece.add_segment(s.start, s.end) : piece.add_segment(s.end, s.start);
    for (const ContactSegment::End& end : s.ends)
      if (end.sign != 0 && end.role == role)
        piece.add_crossing(static_cast<unsigned>(end.edge), end.sign, end.place);
  }
  for (unsigned k = piece.is_far() ? 0 : 2; k < 3; ++k)
    if ((corners_inside(role, face) >> k & 1u) != 0 && find(corner(role, face, k)) == part)
      piece.add_corner_inside(k);
  return piece;
}

// Returns the vertices that a node shares with triangles that are not below it.
std::span<const std::uint32_t> ContactParts::rim(std::uint32_t role, std::uint32_t node) {
  auto& [begin, end] = rim_of_[role][node];
  std::vector<std::uint32_t>& all = rims_[role];
  if (begin == kNone) {
    const SurfaceTree::Summary& below = trees_[role]->summaries()[node];
    begin = static_cast<std::uint32_t>(all.size());
    for (std::uint32_t t = below.first; t < below.end; ++t)
      for (const std::uint32_t v : trees_[role]->triangles()[t])
        if (triangles_of_[role][v][0] < below.first || triangles_of_[role][v][1] >= below.end)
          all.push_back(v);
    const auto from = all.begin() + begin;
    std::sort(from, all.end());
    all.erase(std::unique(from, all.end()), all.end());
    end = static_cast<std::uint32_t>(all.size());
  }
  return std::span(all).subspan(begin, end - begin);
}

std::uint32_t ContactParts::join_whole(std::uint32_t role, std::uint32_t child) {
  const SurfaceTree& tree = *trees_[role];
  if ((child & SurfaceTree::kLeaf) != 0) {
    const auto& [a, b, c] = tree.triangles()[child & ~SurfaceTree::kLeaf];
    join(vertex(role, a), vertex(role, b));
    join(vertex(role, a), vertex(role, c));
    return vertex(role, a);
  }
  const std::span<const std::uint32_t> around = rim(role, child);
  const std::uint32_t any = tree.triangles()[tree.summaries()[child].first][0];
  const std::uint32_t first = vertex(role, around.empty() ? any : around[0]);
  for (const std::uint32_t v : around) join(first, vertex(role, v));
  return first;
}

}  // namespace vpm
