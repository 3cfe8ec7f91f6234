// What a coherent sequence of poses reuses (QueryOptions::reuse): of each cluster of shares what of
// it was behind the surface where that was last read, and how that changes as the tool moves; of
// those that the surface did not reach, how far it was. README.md, "Coherent poses".
//
// Clusters are independent of each other: threads may work on different ones at once.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "libvpm/query/cell.h"
#include "libvpm/query/contact_slopes.h"

namespace vpm {

// What a plane does not reach yet, in the tool's axes about its centre of mass.
struct Clearance {
  double height = 0;  // above the plane; lengths in the tool's reach
  Vec3 normal, center;
  double extent = 0;  // about the centre

  bool holds(const SmallMotion& motion) const {
    const double turn = norm(motion.turn);
    const double lift = dot(normal, motion.shift + cross(motion.turn, center));
    return lift + turn * (extent + turn) < height;  // and what first order leaves out
  }
};

// What is known of a cluster.
struct Contact {
  ToolSum sum;  // what is behind the surface
  ContactSlopes slopes;
  std::uint32_t inside = 0;  // shares that count
  Clearance clearance;       // where nothing is behind the surface

  bool is_empty() const { return sum.volume.value == 0; }
};

class ContactMemory {
 public:
  // `weights` of the clusters: parts of the tool's volume. `groups` of clusters. `limit`: how far
  // any place of the tool may move before a cluster is read again, m.
  ContactMemory(std::vector<double> weights, std::size_t groups, ToolReach reach, double limit)
      : reach_(reach),
        limit_(limit),
        weights_(std::move(weights)),
        ages_(weights_.size()),
        group_ages_(groups),
        uses_(weights_.size()),
        contacts_(weights_.size()) {}

  double limit() const { return limit_; }

  // The next pose. Of another cloud nothing is known.
  void turn(std::uint64_t cloud, const Pose& to_surface);
  void forget() { forget_before_ = pose_ + 1; }

  // Whether anything is known of a cluster that is not too old.
  bool knows(std::uint32_t cluster) const { return is_young(ages_[cluster]); }
  // Whether that tells what of it is behind the surface at this pose. It is used then.
  bool use(std::uint32_t cluster);
  // Of clusters, how this pose uses the memory.
  enum class Use : std::uint8_t {
    none,
    again,  // what is known
    anew,   // begin() has been called
  };
  Use use_of(std::uint32_t cluster) const { return uses_[cluster]; }
  // Of one that is used again, or ended:
  bool is_empty(std::uint32_t cluster) const { return ages_[cluster].is_empty; }
  void add(std::uint32_t cluster, ToolSum& sum) const;  // what is behind the surface
  std::uint32_t inside(std::uint32_t cluster) const {
    return is_empty(cluster) ? 0 : contacts_[cluster].inside;
  }

  // To remember a cluster that is read at this pose is begun where it is read, and ended when all
  // that counts is known. What may pass the surface as a whole within the limit, or may reach it at
  // once, is not remembered: first order says nothing then.
  Contact& begin(std::uint32_t cluster) {
    uses_[cluster] = Use::anew;
    ages_[cluster].is_empty = false;
    return contacts_[cluster] = {};
  }
  bool is_begun(std::uint32_t cluster) const {
    return uses_[cluster] == Use::anew && ages_[cluster].read != pose_;
  }
  Contact& begun(std::uint32_t cluster) { return contacts_[cluster]; }
  void end(std::uint32_t cluster);
  // Of a cluster that the surface does not reach within the limit.
  void remember_free(std::uint32_t cluster) {
    begin(cluster).clearance.height = HUGE_VAL;
    end(cluster);
  }
  void forget(std::uint32_t cluster) { ages_[cluster].until = 0; }

  // Of a group that the surface does not reach within the limit; nothing is known of its clusters.
  void remember_free_group(std::uint32_t group) {
    group_ages_[group] = age(group, group_ages_[group]);
  }
  bool knows_free_group(std::uint32_t group) const { return is_young(group_ages_[group]); }

 private:
  // Poses are numbered from 1. What is known of one that is further back is read again, so that a
  // few origins do: a tool so slow can afford it.
  static constexpr std::uint64_t kOrigins = 16;

  struct Origin {
    Pose to_surface;
    // Since then.
    SmallMotion motion;
    double moved = 0;  // of the place that has moved most, at most; m
  };
  struct Age {
    std::uint64_t read = 0, until = 0;  // the pose, and that at which it is too old
    double limit = 0;                   // m
    bool is_empty = false;              // nothing is behind the surface
  };
  bool is_young(const Age& age) const {
    return age.read >= forget_before_ && pose_ < age.until && origin(age.read).moved <= age.limit;
  }
  Age age(std::uint32_t index, const Age& before) const;  // of what is read now

  Origin& origin(std::uint64_t pose) { return origins_[pose % kOrigins]; }
  const Origin& origin(std::uint64_t pose) const { return origins_[pose % kOrigins]; }

  ToolReach reach_;
  double limit_;
  std::vector<double> weights_;
  std::vector<Age> ages_, group_ages_;
  std::vector<Use> uses_;
  std::vector<Contact> contacts_;
  std::array<Origin, kOrigins> origins_;
  std::uint64_t pose_ = 0, forget_before_ = 1, cloud_ = 0;
};

}  // namespace vpm
