#include "libvpm/synthetic/surface.h"

#include <algorithm>
#include <utility>

namespace vpm::synthetic {
namespace {

class Wall : public Surface {
 public:
  Wall(Vec3 point, Vec3 normal)
      : normal_(normalized_or_zero(normal)), offset_(dot(normal_, point)) {}

  double distance(Vec3 p) const override { return dot(normal_, p) - offset_; }
  Vec3 gradient(Vec3) const override { return normal_; }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    const double slope = dot(normal_, direction);
    if (slope != 0) t.push_back(-distance(origin) / slope);
  }

 private:
  Vec3 normal_;
  double offset_;
};

class Ball : public Surface {
 public:
  // `sign` is 1 for a ball as obstacle, -1 for everything outside the ball.
  Ball(Vec3 center, double radius, double sign) : center_(center), radius_(radius), sign_(sign) {}

  double distance(Vec3 p) const override { return sign_ * (norm(p - center_) - radius_); }
  Vec3 gradient(Vec3 p) const override { return sign_ * normalized_or_zero(p - center_); }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    const Vec3 from = origin - center_;
    const double a = squared_norm(direction), b = dot(from, direction);
    // Nearest point of the line, without cancellation.
    const Vec3 nearest = from - (b / a) * direction;
    const double rest = radius_ * radius_ - squared_norm(nearest);
    if (rest < 0) return;
    const double half = std::sqrt(rest / a);
    t.push_back(-b / a - half);
    t.push_back(-b / a + half);
  }

 private:
  Vec3 center_;
  double radius_, sign_;
};

class Block : public Surface {
 public:
  explicit Block(Vec3 size) : half_(0.5 * size) {}

  double distance(Vec3 p) const override {
    const Vec3 q = beyond(p);
    const Vec3 outside{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
    return norm(outside) + std::min(std::max({q.x, q.y, q.z}), 0.0);
  }
  Vec3 gradient(Vec3 p) const override {
    const Vec3 q = beyond(p);
    const auto side = [](double x) { return x < 0 ? -1.0 : 1.0; };
    if (std::max({q.x, q.y, q.z}) > 0) {
      return normalized_or_zero({side(p.x) * std::max(q.x, 0.0), side(p.y) * std::max(q.y, 0.0),
                                 side(p.z) * std::max(q.z, 0.0)});
    }
    if (q.x >= q.y && q.x >= q.z) return {side(p.x), 0, 0};
    if (q.y >= q.z) return {0, side(p.y), 0};
    return {0, 0, side(p.z)};
  }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    double enter = -HUGE_VAL, leave = HUGE_VAL;
    const auto clip = [&](double from, double slope, double half) {
      if (slope == 0) {
        if (std::abs(from) >= half) leave = -HUGE_VAL;
        return;
      }
      const double a = (-half - from) / slope, b = (half - from) / slope;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    };
    clip(origin.x, direction.x, half_.x);
    clip(origin.y, direction.y, half_.y);
    clip(origin.z, direction.z, half_.z);
    if (enter < leave) t.insert(t.end(), {enter, leave});
  }

 private:
  // Returns how far p lies outside each pair of faces.
  Vec3 beyond(Vec3 p) const {
    return {std::abs(p.x) - half_.x, std::abs(p.y) - half_.y, std::abs(p.z) - half_.z};
  }
  Vec3 half_;
};

class Prism : public Surface {
 public:
  explicit Prism(std::vector<std::array<double, 2>> polygon) : polygon_(std::move(polygon)) {
    double twice_area = 0;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const auto [a, b] = edge(i);
      twice_area += cross_xz(a, b);
    }
    turn_ = twice_area < 0 ? -1 : 1;
  }

  double distance(Vec3 p) const override {
    const double length = norm(nearest(p).offset);
    return is_inside(p) ? -length : length;
  }
  // Returns an edge's normal above its interior, also on the surface itself; beside its ends, the
  // direction away from the corner.
  Vec3 gradient(Vec3 p) const override {
    const Nearest at = nearest(p);
    const Vec3 away = normalized_or_zero(-at.offset);
    if (!at.is_corner || away == Vec3{}) {
      const auto [a, b] = edge(at.edge);
      return turn_ * normalized_or_zero({b.z - a.z, 0, a.x - b.x});
    }
    return is_inside(p) ? -away : away;
  }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      // Uses half-open intervals on the line's sides, so that a corner counts once.
      const auto [a, b] = edge(i);
      const double side_a = cross_xz(direction, a - origin),
                   side_b = cross_xz(direction, b - origin);
      if ((side_a < 0) == (side_b < 0)) continue;
      const Vec3 hit = a + (side_a / (side_a - side_b)) * (b - a);
      const double squared = direction.x * direction.x + direction.z * direction.z;
      t.push_back(((hit.x - origin.x) * direction.x + (hit.z - origin.z) * direction.z) / squared);
    }
  }

 private:
  static double cross_xz(Vec3 a, Vec3 b) { return a.x * b.z - a.z * b.x; }

  std::pair<Vec3, Vec3> edge(std::size_t i) const {
    const auto &a = polygon_[i], &b = polygon_[(i + 1) % polygon_.size()];
    return {{a[0], 0, a[1]}, {b[0], 0, b[1]}};
  }
  struct Nearest {
    Vec3 offset;  // relative to p
    std::size_t edge = 0;
    bool is_corner = false;
  };
  Nearest nearest(Vec3 p) const {
    p.y = 0;
    Nearest best;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const auto [a, b] = edge(i);
      const Vec3 along = b - a;
      const double s = dot(p - a, along) / squared_norm(along);
      const Vec3 offset = a + std::clamp(s, 0.0, 1.0) * along - p;
      if (const double squared = squared_norm(offset); squared < least) {
        least = squared;
        best = {offset, i, !(s > 0 && s < 1)};
      }
    }
    return best;
  }
  bool is_inside(Vec3 p) const {
    bool inside = false;
    for (std::size_t i = 0; i < polygon_.size(); ++i) {
      const auto [a, b] = edge(i);
      if ((a.z > p.z) == (b.z > p.z)) continue;
      if (p.x < a.x + (b.x - a.x) * (p.z - a.z) / (b.z - a.z)) inside = !inside;
    }
    return inside;
  }

  std::vector<std::array<double, 2>> polygon_;
  double turn_ = 1;  // -1 for the other orientation of the polygon
};

class Placed : public Surface {
 public:
  Placed(SurfacePtr local, const Pose& to_world)
      : local_(std::move(local)), to_world_(to_world), to_local_(inverse(to_world)) {}

  double distance(Vec3 p) const override { return local_->distance(to_local_ * p); }
  Vec3 gradient(Vec3 p) const override {
    return to_world_.rotation * local_->gradient(to_local_ * p);
  }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    local_->crossings(to_local_ * origin, to_local_.rotation * direction, t);
  }

 private:
  SurfacePtr local_;
  Pose to_world_, to_local_;
};

class Union : public Surface {
 public:
  explicit Union(std::vector<SurfacePtr> parts) : parts_(std::move(parts)) {}

  double distance(Vec3 p) const override { return nearest(p).distance(p); }
  Vec3 gradient(Vec3 p) const override { return nearest(p).gradient(p); }
  void crossings(Vec3 origin, Vec3 direction, std::vector<double>& t) const override {
    for (const SurfacePtr& part : parts_) part->crossings(origin, direction, t);
  }

 private:
  const Surface& nearest(Vec3 p) const {
    return **std::min_element(parts_.begin(), parts_.end(), [&](const auto& a, const auto& b) {
      return a->distance(p) < b->distance(p);
    });
  }
  std::vector<SurfacePtr> parts_;
};

}  // namespace

SurfacePtr make_wall(Vec3 point, Vec3 normal) {
  return std::make_shared<Wall>(point, normal);
}
SurfacePtr make_ball(Vec3 center, double radius) {
  return std::make_shared<Ball>(center, radius, 1);
}
SurfacePtr make_inverted_ball(Vec3 center, double radius) {
  return std::make_shared<Ball>(center, radius, -1);
}
SurfacePtr make_block(Vec3 size, const Pose& to_world) {
  return std::make_shared<Placed>(std::make_shared<Block>(size), to_world);
}
SurfacePtr make_prism(std::vector<std::array<double, 2>> polygon, const Pose& to_world) {
  return std::make_shared<Placed>(std::make_shared<Prism>(std::move(polygon)), to_world);
}
SurfacePtr make_union(std::vector<SurfacePtr> parts) {
  return std::make_shared<Union>(std::move(parts));
}

}  // namespace vpm::synthetic
