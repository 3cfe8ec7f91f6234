// Integrals over the boundary of what two solids share: the parts of each surface inside the other.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "libvpm/core/box.h"
#include "libvpm/solid/contact_parts.h"
#include "libvpm/solid/crossed_triangle.h"
#include "libvpm/solid/depth_cells.h"
#include "libvpm/solid/depth_fan.h"
#include "libvpm/solid/face_planes.h"
#include "libvpm/solid/linear_force.h"
#include "libvpm/solid/solid_surface.h"
#include "libvpm/solid/tree_walk.h"
#include "libvpm/solid/triangle_pair.h"
#include "libvpm/solid/wide_sum.h"

namespace vpm {

// What is summed over one surface's part inside the other solid, in the first's frame.
struct InnerSurface {
  SurfaceMoments moments;
  // ∫ -depth n dA and ∫ -depth x cross n dA, with the depth below the other's surface; in m^3, m^4.
  Vec3 force, torque;
};

// Place on the surface of `role`, in the first's frame, and how deep it is taken to be below the
// other's surface, m.
struct DeepPlace {
  double depth = 0;
  Vec3 place;
  std::uint32_t role = 0;
};

// A connected part of the boundary of what both contain, in the first's frame.
struct SurfaceContact {
  std::array<InnerSurface, 2> inner;
  // Two places where a surface may lie deepest inside the other solid: of those at which forces
  // sampled the depth, and of corners, whose depth is continued linearly from the nearest sample.
  std::array<DeepPlace, 2> deepest;
};

struct SurfacePairSums {
  std::array<InnerSurface, 2> inner;
  // Area of the one surface inside the other, or of the other inside the one, m^2; the larger. Up
  // to that, of surfaces without depth.
  double area = 0;
  std::size_t undecided = 0;  // pairs of triangles whose signs contradict each other
  std::size_t whole = 0;      // pieces of surface that nothing crosses and that lie inside
  // Counts for tests and benchmarks.
  std::size_t candidates = 0, crossings = 0, depths = 0;
};

// Scratch of a pair of surfaces at changing poses. Belongs to one thread. The surfaces must outlive
// it.
class SurfacePair {
 public:
  SurfacePair(const SolidSurface& first, const SolidSurface& second);

  // Returns the moments of a surface's part inside, in the first's frame, of its sums in the unit:
  // those of what is inside as a whole, in its own frame, and of crossed triangles in the first's.
  static SurfaceMoments moments_of(const SurfaceMoments& whole, const SurfaceMoments& cut,
                                   double unit, const Pose& to_first);

  // Sums at a pose, which maps the second's frame to the first's. Allocates nothing once its lists
  // have grown. The order of triangles changes no bit of the sums.
  SurfacePairSums run(const Pose& pose, bool with_force, bool with_contacts = false);

  // Returns the parts of which the last sums are made, if these were asked `with_contacts`, in no
  // particular order but always the same. They add up to the sums, to rounding.
  std::span<const SurfaceContact> contacts() const { return contacts_; }

  // Returns the depth below the other's surface where the contact lies deepest, m, at the last
  // pose.
  double greatest_depth(const SurfaceContact& contact) const;

 private:
  static constexpr std::uint32_t kLeaf = SurfaceTree::kLeaf, kNone = SurfaceTree::kNone;

  // Sums over crossed triangles in the first's frame, over others in the surface's own (but moments
  // of solids that are summed by triangles in the first's); in the unit.
  struct RoleSums {
    WideMoments cut, whole;
    WideWrench cut_wrench, whole_wrench;  // times wrench_scale_
    WideSum area;
    void subtract(const RoleSums& o);
  };
  // Part of a surface whose depth is taken for linear, and its force; in the first's frame and the
  // unit, but for the place.
  struct LinearPiece {
    Depth depth;  // at the place
    Vec3 place;
    ForceAndTorque force;
    Vec3 middle = {};   // of the piece; set for contacts
    double weight = 1;  // of the force
  };
  // A depth that is linear near a place, which tells what to expect beside it, and the weight of
  // the force there.
  struct Foretold {
    Depth depth;
    Vec3 place;
    bool is_known = false;
    double weight = 1;
    double at(Vec3 x) const { return depth.value + dot(depth.gradient, x - place); }
  };
  // How finely the depth is sampled for the volume at hand; in the unit.
  struct Precision {
    double size = 1;      // of pieces that are taken without a second look, relative to the largest
    double depth = 0;     // error that pieces may have, on average over each,
    double product = 0;   // or times its area
    double smallest = 0;  // size of pieces that are never cut
    double mean = 0;      // depth
  };
  // Middle of a piece, in the first's frame and the unit.
  struct Probe {
    double area;
    Vec3 place;
    std::uint32_t role;
  };
  class CellVisitor;
  // Node (or kLeaf | triangle) that lies inside as a whole. Contacts are summed from these
  struct WholePiece {
    std::uint32_t role, child;
    std::uint32_t element;  // of the parts
  };
  // and the force on a piece of a surface, as it was added to the sums.
  struct ForcePiece {
    std::uint32_t role;
    bool is_cut, is_of_whole;
    std::uint32_t source;  // number of a whole piece, or element of the parts
    ForceAndTorque force;
    std::array<DeepPlace, 2> deepest;  // as those of contacts
  };
  // Number of a triangle among those of a pose, if the stamp is the pose's.
  struct Listed {
    std::uint32_t stamp = 0, place = 0;
  };
  // One of the two surfaces. Stamps are those of the last pose where they equal `stamp_`.
  struct Role {
    const SolidSurface* solid = nullptr;
    const SurfaceTree* tree = nullptr;
    bool is_summed_by_triangles = false;  // as outgrows() tells
    // For forces: how many times as large errors may be here as on the other surface, whose force
    // counts more; and the largest pieces, m: nodes, cells, crossed triangles as a whole, and cells
    // that may stay for what samples tell, however deep they are.
    double ease = 1, largest_patch = 0, largest_cell = 0, largest_crossed = 0, largest_judged = 0;
    FacePlanes other_planes;  // if the other has few faces: in the first's frame and the unit
    Pose to_first, to_other;  // from its own frame
    std::vector<std::uint32_t> listed;   // triangles that may meet the other's,
    std::vector<PlacedTriangle> placed;  // and these in the first's frame
    std::vector<CrossedTriangle> crossed;
    // What cuts them, for forces: each entry names the one before of the same triangle.
    std::vector<std::pair<CutSegment, std::uint32_t>> segments;
    std::vector<std::pair<CutPoint, std::uint32_t>> points;
    std::vector<std::uint32_t> crossed_stamp, crossed_place;  // of triangles
    std::vector<Listed> place_of;                             // of triangles
    std::vector<std::uint32_t> node_stamp;                    // nodes above a crossed triangle
    std::vector<std::uint32_t> corner_stamp;                  // vertices whose side is known
    std::vector<std::uint8_t> is_inside;                      // of vertices
    RoleSums sums;
  };

  void start(const Pose& pose, bool with_force, bool with_contacts);
  PlacedTriangle placed(const Role& role, std::uint32_t triangle) const;
  std::uint32_t place_of(Role& role, std::uint32_t triangle);
  void list_triangles();
  void meet_all();
  void meet(CandidatePair places, const PairSigns& signs, TriangleCrossing& crossing);
  CrossedTriangle& crossed(Role& role, std::uint32_t triangle, const PlacedTriangle& placed);
  bool is_inside(std::size_t role, std::uint32_t vertex);
  void mark_crossed(std::size_t role);
  void add_crossed(std::size_t role);
  void add_whole(std::size_t role);
  void add_whole_triangle(std::size_t role, std::uint32_t triangle);
  void add_moments(const Role& role, std::uint32_t child, RoleSums& sums) const;
  void note_cut(std::size_t role, CrossedTriangle& triangle, const CrossedTriangle& other,
                CutSegment segment, std::span<const EdgeCrossing> crossings);
  SurfaceMoments moments_of(const Role& role, const RoleSums& sums) const;
  InnerSurface result(const Role& role, const RoleSums& sums) const;

  // Of forces (surface_forces.cpp).
  void add_wrench(WideWrench& sum, const ForceAndTorque& f) const {
    sum.add(wrench_scale_ * f.force, wrench_scale_ * f.torque);
  }
  // Returns SurfacePairSums::area, in the unit.
  double area_inside() const { return per_unit_ * per_unit_ * sums_.area; }
  void add_forces();
  Precision precision();
  double depth_of_largest();
  static void set_sizes(Role& role, const SolidSurface& other);
  double share_of_precise(std::size_t role, double error, double area) const;
  double share_of_small(double size, double most) const;
  // Returns the planes of the other solid below which a surface's depth is told; null if it is
  // sampled.
  const FacePlanes* planes_below(std::size_t role) const {
    return roles_[1 - role].solid->face_planes();
  }
  void add_force_of_crossed(std::size_t role, const CrossedTriangle& triangle);
  void add_force_of_whole(std::size_t role, std::uint32_t child);
  void add_force_of_triangle(std::size_t role, std::uint32_t triangle, const Foretold& before);
  double add_force_of_patch(std::size_t role, std::uint32_t node, Foretold& foretold);
  void add_force_of_node(std::size_t role, std::uint32_t node, const Depth& depth, Vec3 middle,
                         double weight);
  void add_force_of_cells(std::size_t role, const DepthCell& cell, Vec3 normal, double weight);
  void add_force_of_small_cell(std::size_t role, const DepthCell& cell, Vec3 normal, double weight);
  static void add_cuts(const DepthCell& cell, CrossedTriangle& part);
  std::optional<LinearPiece> add_force_of_cut(std::size_t role, const CrossedTriangle& triangle,
                                              std::span<const CutSegment> segments);
  Foretold plane_across(std::size_t role, std::span<const CutSegment> segments) const;
  static double share_of_agreeing(const Foretold& below_planes);
  double share_of_plausible(std::size_t role, const Foretold& below_planes, Vec3 middle) const;
  Foretold mixed_with_depth(std::size_t role, const Foretold& below_planes, double share,
                            Vec3 place);
  Foretold bent(std::size_t role, const DepthCell& cell, Foretold linear, Vec3 middle) const;
  Foretold depth_at(std::size_t role, Vec3 place);
  LinearPiece add_cut_force(std::size_t role, const ForceMoments& moments, const Foretold& linear,
                            double weight);

  // Of forces below planes (plane_forces.cpp).
  void add_force_below_planes(std::size_t role, const CrossedTriangle& triangle);
  void add_force_of_whole_below_planes(std::size_t role, std::uint32_t child);
  void note_force_below_planes(std::size_t role, std::uint32_t element,
                               const DepthIntegral& integral, Vec3 normal,
                               const FacePlanes::Near::OfTriangle& of_triangle);

  // Of contacts (surface_contacts.cpp).
  void note_whole(std::size_t role, std::uint32_t child);
  void note_force_of_whole(std::size_t role, const ForceAndTorque& force, const Depth& depth,
                           Vec3 place, double radius, std::uint32_t begin, std::uint32_t end);
  void note_deep_places(const DeepPlace& sampled, const DeepPlace& linear);
  void note_force_of_face(std::size_t role, const CrossedTriangle& triangle,
                          const LinearPiece& piece);
  void note_force_of_cell(std::size_t role, const DepthCell& cell, const LinearPiece& piece,
                          Vec3 normal);
  static LinearPiece part_of(const LinearPiece& piece, const CrossedTriangle& part);
  void note_force_of_split_cell(std::size_t role, const DepthCell& cell, const LinearPiece& piece,
                                Vec3 normal);
  void note_cut_force(std::size_t role, std::uint32_t element, const LinearPiece& piece,
                      std::span<const Vec3> corners, unsigned inside);
  void join_crossed();
  void find_contacts();
  void number_contacts();
  void sum_contacts();
  void add_pieces(std::uint32_t largest);
  void merge_contacts();
  std::uint32_t around_hollow(std::uint32_t hollow);
  Box box_of(std::uint32_t contact);
  std::uint32_t contact_of(const ForcePiece& piece);

  std::array<Role, 2> roles_;
  TreeWalk walk_;
  std::vector<CandidatePair> candidates_;                    // as places in the roles' lists
  std::vector<PairSigns> signs_;                             // what doubles tell of these
  std::vector<std::uint32_t> pending_;                       // nodes
  std::vector<std::pair<std::uint32_t, Foretold>> patches_;  // nodes, and what their parents tell
  DepthCells cells_;
  DepthFan fan_;
  std::vector<DepthFan::Plane> planes_;
  std::vector<CutSegment> cut_segments_;  // of one triangle
  std::vector<CutPoint> cut_points_;
  std::uint32_t stamp_ = 0;
  double unit_, per_unit_;   // m, a power of two that no coordinate exceeds, and its inverse
  double wrench_scale_ = 1;  // a power of two that makes terms of wrenches 1 or so: sums round so
  bool with_force_ = false, with_contacts_ = false;
  bool is_one_contact_ = false;  // known before the sums, which then are its own
  SurfacePairSums sums_;
  std::unique_ptr<ContactParts> parts_;  // null until contacts are asked
  std::vector<WholePiece> whole_pieces_;
  std::vector<ForcePiece> force_pieces_;
  std::uint32_t face_ = 0;  // place of the crossed triangle whose force is added; kNone: of a whole
  std::uint32_t whole_ = 0;  // number of that
  Precision precision_;
  std::vector<Probe> probes_;
  std::vector<std::uint32_t> number_of_;  // contact, by the elements of the parts that stand for it
  std::vector<std::array<RoleSums, 2>> contact_sums_;
  std::vector<SurfaceContact> contacts_;
};

}  // namespace vpm
