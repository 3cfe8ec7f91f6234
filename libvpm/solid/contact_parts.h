// Which parts of the boundary of what two solids share hang together: each such part bounds one
// contact.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "libvpm/solid/crossed_triangle.h"
#include "libvpm/solid/surface_tree.h"

namespace vpm {

// Segment that a triangle of the first surface shares with one of the second. It bounds the part of
// the first's inside the second solid from start to end, that of the second's from end to start.
struct ContactSegment {
  // Point where an edge of a triangle of surface `role`, from corner `edge` to the next, passes
  // through the other's triangle; sign as EdgeCrossing::sign.
  struct End {
    std::uint32_t role = 0;
    int edge = 0, sign = 0;
    Vec3 place;
  };
  std::array<std::uint32_t, 2> face;  // of each surface: place in its list of crossed triangles
  std::array<std::uint32_t, 2> next;  // segment of the same face, kNone after the last
  Vec3 start, end;
  std::array<End, 2> ends;
};

// Joins segments, and vertices inside the other solid, by union-find. Segments are joined where one
// goes on in the other, along edges between two crossings, and across faces where the part inside
// has holes; triangles and nodes that nothing crosses by the vertices that they share with others.
// Two that are joined though they do not hang together would do no harm but to count as one: the
// boundary of each part is closed either way. Belongs to one thread.
class ContactParts {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // The trees must outlive it.
  ContactParts(const SurfaceTree& first, const SurfaceTree& second);

  // Forgets all that was added.
  void start();

  // Adds what two crossed triangles share, scaled by `per_unit`, as in their corners.
  void add(std::array<std::uint32_t, 2> face, const TriangleCrossing& crossing, double per_unit);

  // Joins segments along the edges of the crossed triangles, after all segments are added.
  void join_along_edges(std::array<std::span<const CrossedTriangle>, 2> faces);

  // Joins what the corners and the holes of the crossed triangles tell. `is_inside(role, vertex)`
  // tells if a vertex is inside the other solid; it is asked once for each crossed triangle.
  template <class IsInside>
  void join_across_faces(const IsInside& is_inside) {
    for (std::uint32_t role = 0; role < 2; ++role) {
      corners_inside_[role].resize(faces_[role].size());
      for (std::uint32_t f = 0; f < faces_[role].size(); ++f)
        join_corners(role, f, is_inside(role, corners(role, f)[2]));
    }
    for (std::uint32_t role = 0; role < 2; ++role) join_holes(role);
  }

  // Joins the vertices of a triangle (SurfaceTree::kLeaf | triangle) or those by which a node
  // touches what is around it, none of which is crossed and all inside. Returns one of them.
  std::uint32_t join_whole(std::uint32_t role, std::uint32_t child);

  // Returns the number that stands for all that a segment or vertex is joined with.
  std::uint32_t find(std::uint32_t element);
  std::size_t elements() const { return parent_.size(); }
  std::span<const ContactSegment> segments() const { return segments_; }
  // Returns how many parts the segments form so far, counted up to two.
  int parts_of_segments();
  // Returns what all segments of a face are joined with, kNone if that is more than one part.
  std::uint32_t part_of_face(std::uint32_t role, std::uint32_t face);
  // Returns the parts to which a face's segments belong, in a list that the next call changes.
  std::span<const std::uint32_t> parts_of_face(std::uint32_t role, std::uint32_t face);
  // Returns a bit for each corner of a face that is inside the other solid.
  unsigned corners_inside(std::uint32_t role, std::uint32_t face) const {
    return corners_inside_[role][face];
  }
  // Returns the element that stands for a corner of a face.
  std::uint32_t corner(std::uint32_t role, std::uint32_t face, std::size_t k) {
    return vertex(role, corners(role, face)[k]);
  }
  // Returns integrals over what belongs to one part, of the part of a face inside.
  CrossedTriangle piece(std::uint32_t role, std::uint32_t face, std::uint32_t part);
  // Returns a segment or vertex at the border of the part of a face inside that holds a place: what
  // a ray from there meets first. Passes over the segments of a chain (kNone: over none).
  std::uint32_t element_at(std::uint32_t role, std::uint32_t face, Vec3 place,
                           std::uint32_t chain = kNone);

 private:
  // Edge that is crossed, from its lower to its higher vertex.
  struct Edge {
    std::uint32_t role, low, high;
    std::uint32_t last;  // crossing
    bool low_inside, high_inside;
  };
  struct Crossing {
    std::uint32_t segment, face;  // the other's
    std::uint32_t next;
    bool enters;   // from the lower vertex to the higher
    double along;  // orders the crossings of one edge
  };

  const Triangle& corners(std::uint32_t role, std::uint32_t face) const {
    return trees_[role]->triangles()[faces_[role][face].triangle];
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = find(a), b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  std::uint32_t vertex(std::uint32_t role, std::uint32_t v);
  static std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t k);
  std::size_t slot_of(std::uint32_t role, std::uint32_t low, std::uint32_t high) const;
  const Edge* edge(std::uint32_t role, std::uint32_t p, std::uint32_t q) const;
  void add_crossing(std::uint32_t segment, const ContactSegment::End& end);
  void grow();
  void sort_crossings(const Edge& edge);
  void join_along(Edge& edge);
  void join_corners(std::uint32_t role, std::uint32_t face, bool far_inside);
  void join_holes(std::uint32_t role);
  std::uint32_t element_on_edge(std::uint32_t role, std::uint32_t face, std::size_t k, Vec3 place);
  std::span<const std::uint32_t> rim(std::uint32_t role, std::uint32_t node);

  std::array<const SurfaceTree*, 2> trees_;
  std::array<std::span<const CrossedTriangle>, 2> faces_;
  std::vector<ContactSegment> segments_;
  std::array<std::vector<std::uint32_t>, 2> last_of_face_;  // segment
  std::array<std::vector<std::uint8_t>, 2> corners_inside_;
  std::vector<Edge> edges_;
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> slots_;   // of a hash table: edges, or kNone
  std::vector<std::uint32_t> parent_;  // segments, then vertices
  // Segments that go on in each other within one face, for each surface; chains that come to an
  // edge of their face are open.
  std::array<std::vector<std::uint32_t>, 2> chain_;
  std::array<std::vector<std::uint8_t>, 2> is_open_;
  std::vector<const Crossing*> sorted_;
  std::vector<double> areas_;
  std::vector<std::uint32_t> extremes_;  // of chains: segments
  std::vector<std::uint32_t> found_;
  std::array<std::vector<std::uint32_t>, 2> vertex_element_, vertex_stamp_;
  std::uint32_t stamp_ = 0;
  // First and last triangle of each vertex, and what was found of nodes: begin and end in `rims_`.
  std::array<std::vector<std::array<std::uint32_t, 2>>, 2> triangles_of_, rim_of_;
  std::array<std::vector<std::uint32_t>, 2> rims_;
};

}  // namespace vpm
