// The robot in its own picture: what known solids explain leaves the depth image, and nothing else
// does.

#include "libvpm/solid/depth_remover.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <vector>

#include "libvpm/cloud/normals.h"
#include "libvpm/core/error.h"
#include "libvpm/query/tool_query.h"
#include "libvpm/scene/any_body.h"
#include "libvpm/synthetic/shapes.h"
#include "tests/query/lattice_model.h"
#include "tests/solid/pair_cases.h"

namespace vpm {
namespace {

using Surface = std::shared_ptr<const SolidSurface>;

const Camera kCamera{{131, 127, 79.3, 60.1}, 160, 120, {}};
constexpr int kSub = 3;  // rays per pixel along each axis

// What the rays through a pixel meet first: kSub x kSub of them.
struct Rays {
  std::vector<double> depth;  // HUGE_VAL where there is nothing
  std::vector<int> what;      // number of the solid; -1: nothing, or clutter

  explicit Rays(const Camera& camera)
      : depth(std::size_t{camera.width} * camera.height * kSub * kSub, HUGE_VAL),
        what(depth.size(), -1) {}
};

Vec3 ray(const Camera& camera, int u, int v, int sub) {
  const double du = (sub % kSub - 1) / double(kSub), dv = (sub / kSub - 1) / double(kSub);
  return unproject(camera.intrinsics, u + du, v + dv, 1);
}

// Meets every ray with every triangle, by the product of the corners.
void add_solid(const Solid& solid, const Pose& pose, int number, const Camera& camera, Rays& rays) {
  for (const Triangle& t : solid.triangles) {
    const Pose to_camera = relative_to(camera.to_world, pose);
    const Vec3 a = to_camera * solid.vertices[t[0]], b = to_camera * solid.vertices[t[1]],
               c = to_camera * solid.vertices[t[2]];
    int u0 = 0, u1 = static_cast<int>(camera.width) - 1, v0 = 0,
        v1 = static_cast<int>(camera.height) - 1;
    if (std::min({a.z, b.z, c.z}) > 1e-3) {  // only the pixels of its box
      const Intrinsics& k = camera.intrinsics;
      const auto [ulow, uhigh] = std::minmax({a.x / a.z, b.x / b.z, c.x / c.z});
      const auto [vlow, vhigh] = std::minmax({a.y / a.z, b.y / b.z, c.y / c.z});
      u0 = std::max(u0, static_cast<int>(std::clamp(k.fx * ulow + k.cx - 1, -1.0, 1e4)));
      u1 = std::min(u1, static_cast<int>(std::clamp(k.fx * uhigh + k.cx + 2, -1.0, 1e4)));
      v0 = std::max(v0, static_cast<int>(std::clamp(k.fy * vlow + k.cy - 1, -1.0, 1e4)));
      v1 = std::min(v1, static_cast<int>(std::clamp(k.fy * vhigh + k.cy + 2, -1.0, 1e4)));
    }
    for (int v = v0; v <= v1; ++v)
      for (int u = u0; u <= u1; ++u)
        for (int s = 0; s < kSub * kSub; ++s) {
          const Vec3 r = ray(camera, u, v, s);
          const double x = dot(r, cross(a, b)), y = dot(r, cross(b, c)), z = dot(r, cross(c, a));
          if (!((x >= 0 && y >= 0 && z >= 0) || (x <= 0 && y <= 0 && z <= 0))) continue;
          const Vec3 normal = cross(b - a, c - a);
          const double d = dot(normal, a) / dot(normal, r);
          const std::size_t at =
              (static_cast<std::size_t>(v) * camera.width + static_cast<std::size_t>(u)) * kSub *
                  kSub +
              static_cast<std::size_t>(s);
          if (!(d > 0) || !(d < rays.depth[at])) continue;
          rays.depth[at] = d;
          rays.what[at] = number;
        }
  }
}

// Returns the image that a camera measures: where the rays of a pixel differ, something between
// them.
std::vector<float> measured(const Rays& rays, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(0, 1), noise(-0.004, 0.004);
  std::vector<float> depth;
  for (std::size_t p = 0; p < rays.depth.size(); p += kSub * kSub) {
    const auto [low, high] =
        std::minmax_element(rays.depth.begin() + static_cast<std::ptrdiff_t>(p),
                            rays.depth.begin() + static_cast<std::ptrdiff_t>(p + kSub * kSub));
    const double middle = rays.depth[p + kSub * kSub / 2];
    const bool is_mixed = *high > 1.05 * *low && *high < HUGE_VAL;
    const double d = is_mixed ? *low + part(random) * (*high - *low) : middle;
    depth.push_back(d < HUGE_VAL ? static_cast<float>(d * (1 + noise(random))) : 0.0F);
  }
  return depth;
}

// True if the pixel shows a part of a solid.
bool shows(const Rays& rays, std::size_t pixel) {
  for (std::size_t s = 0; s < kSub * kSub; ++s)
    if (rays.what[pixel * kSub * kSub + s] >= 0) return true;
  return false;
}

// True if the pixel shows something, maybe beside others, that is nearer than `depth`.
bool shows_nearer(const Rays& rays, std::size_t pixel, double depth) {
  const auto first = rays.depth.begin() + static_cast<std::ptrdiff_t>(pixel * kSub * kSub);
  return *std::min_element(first, first + kSub * kSub) < depth;
}

// Depths, m, beyond the box that stands before the arm, and of its pixels that are not mixed.
constexpr double kBeforeArm = 0.76, kUnmixed = 0.72;

struct Link {
  Solid solid;
  Pose pose;
};

// Returns an arm of seven links, from the left before the camera to a hand of two fingers.
std::vector<Link> arm() {
  const auto at = [](double x, double y, double z, Vec3 turn) {
    return Pose{exact_rotation(rotation_from_vector(turn)), {x, y, z}};
  };
  return {{synthetic::make_box(0.12, 0.3, 0.12), at(-0.45, 0.2, 1.3, {0, 0, 0.1})},
          {synthetic::make_icosphere(0.08, 2), at(-0.42, 0.0, 1.3, {})},
          {synthetic::make_box(0.4, 0.08, 0.09), at(-0.22, -0.05, 1.2, {0, 0.4, -0.2})},
          {synthetic::make_torus(0.06, 0.03, 24, 12), at(0, -0.1, 1.1, {0.5, 0.3, 0})},
          {synthetic::make_box(0.06, 0.25, 0.06), at(0.05, 0.02, 1.05, {0.3, 0, -0.3})},
          {synthetic::make_box(0.03, 0.12, 0.035), at(0.08, 0.16, 1.0, {0.2, 0, 0.1})},
          {synthetic::make_box(0.03, 0.12, 0.035), at(0.16, 0.15, 1.0, {0.2, 0, -0.1})}};
}

// Adds a wall, a box on it, and one before the arm.
void add_clutter(Rays& rays) {
  add_solid(synthetic::make_box(9, 9, 0.1), test::at({0, 0, 2}), -1, kCamera, rays);
  add_solid(synthetic::make_box(0.3, 0.3, 0.3), test::at({0.4, 0.2, 1.7}), -1, kCamera, rays);
  add_solid(synthetic::make_box(0.1, 0.2, 0.05), test::at({-0.2, 0.05, 0.7}), -1, kCamera, rays);
}

Rays rays_of(const std::vector<Link>& links) {
  Rays rays(kCamera);
  add_clutter(rays);
  for (std::size_t k = 0; k < links.size(); ++k)
    add_solid(links[k].solid, links[k].pose, static_cast<int>(k), kCamera, rays);
  return rays;
}

std::vector<Surface> surfaces_of(const std::vector<Link>& links) {
  std::vector<Surface> surfaces;
  for (const Link& link : links) surfaces.push_back(test::surface(link.solid));
  return surfaces;
}

std::vector<SolidPlace> places_of(const std::vector<Link>& links, double margin) {
  std::vector<SolidPlace> places;
  for (const Link& link : links) places.push_back({link.pose, margin});
  return places;
}

// Moves each link so that no point of it goes further than `distance`: half of it by a turn.
std::vector<Link> displaced(std::vector<Link> links, double distance, std::mt19937_64& random) {
  std::normal_distribution<double> any;
  const auto direction = [&] {
    return normalized_or_zero({any(random), any(random), any(random)});
  };
  for (Link& link : links) {
    const double reach = bounding_radius(link.solid, {});
    const Rotation turn =
        exact_rotation(rotation_from_vector(0.5 * distance / reach * direction()));
    link.pose = {turn * link.pose.rotation, link.pose.translation + 0.5 * distance * direction()};
  }
  return links;
}

std::size_t removed_in(const std::vector<float>& depth) {
  return static_cast<std::size_t>(std::ranges::count_if(depth, is_removed));
}

TEST(DepthRemover, LeavesNoPixelOfAnArm) {
  const std::vector<Link> links = arm();
  DepthRemover remover(surfaces_of(links));
  std::mt19937_64 random(7);
  for (const double speed : {0.1, 0.5, 2.0})
    for (const double late : {0.0, 0.02, 0.05})
      for (const double calibration : {0.0, 0.005}) {
        SCOPED_TRACE(::testing::Message() << speed << ' ' << late << ' ' << calibration);
        const double margin = speed * late + calibration;
        const Rays truth = rays_of(displaced(links, margin, random));
        const std::vector<float> before = measured(truth, random);
        std::vector<float> depth = before;
        const std::size_t removed = remover.remove(places_of(links, margin), kCamera, depth);
        std::size_t left = 0, silhouette = 0, of_arm = 0, kept = 0, before_arm = 0;
        const Rays stated = rays_of(links);
        for (std::size_t p = 0; p < depth.size(); ++p) {
          const bool is_before = shows_nearer(truth, p, kBeforeArm);
          const bool is_arm = shows(truth, p) && !is_before;
          silhouette += shows(stated, p);
          of_arm += is_arm;
          left += is_arm && !is_removed(depth[p]);
          before_arm += is_before && before[p] < kUnmixed;
          kept += is_before && before[p] < kUnmixed && depth[p] == before[p];
        }
        EXPECT_EQ(left, 0);
        EXPECT_GT(of_arm, 1000);
        EXPECT_GE(removed, of_arm);
        EXPECT_EQ(removed, removed_in(depth));
        EXPECT_GT(before_arm, 200);
        // What is before the arm stays, but for mixed pixels.
        EXPECT_GE(50 * kept, 49 * before_arm);
        if (margin == 0) {
          EXPECT_LE(static_cast<double>(removed), 1.5 * static_cast<double>(silhouette));
        }
        for (const RemovedSolid& found : remover.found()) {
          EXPECT_GT(found.in_view, 10);
          EXPECT_FALSE(found.holds_camera);
          if (margin == 0) {
            EXPECT_GE(3 * found.explained, found.in_view - found.hidden);
          }
        }
      }
}

// Solids anywhere, before the camera, behind it and through its plane: each pixel that meets one is
// removed, and none further than two pixels from these.
TEST(DepthRemover, RemovesWhatASolidHides) {
  std::mt19937_64 random(3);
  const std::vector<Solid> shapes{synthetic::make_box(0.3, 0.2, 0.5),
                                  synthetic::make_icosphere(0.2, 3),
                                  synthetic::make_torus(0.3, 0.05, 30, 9),
                                  synthetic::make_box(0.02, 0.02, 1.5), synthetic::make_cube(0.01)};
  std::size_t hidden = 0, crossing = 0;
  for (int n = 0; n < 25; ++n) {
    const Solid& solid = shapes[static_cast<std::size_t>(n) % shapes.size()];
    Pose pose = test::random_pose(random, 0.5);
    pose.translation.z += 0.4;
    SCOPED_TRACE(n);
    const auto is_behind = [&](const Vec3& x) { return (pose * x).z < 0; };
    crossing += std::ranges::any_of(solid.vertices, is_behind) &&
                !std::ranges::all_of(solid.vertices, is_behind);
    Rays rays(kCamera);
    add_solid(solid, pose, 0, kCamera, rays);
    std::vector<float> depth(std::size_t{kCamera.width} * kCamera.height, 5.0F);
    const std::vector<Surface> surface{test::surface(solid)};
    DepthRemover remover(surface);
    const SolidPlace place{pose, 0};
    remover.remove({&place, 1}, kCamera, depth);
    const int width = static_cast<int>(kCamera.width), height = static_cast<int>(kCamera.height);
    const auto is_hit = [&](int u, int v) {
      return u >= 0 && v >= 0 && u < width && v < height &&
             shows(rays, static_cast<std::size_t>(v * width + u));
    };
    for (int v = 0; v < height; ++v)
      for (int u = 0; u < width; ++u) {
        const bool is_out = is_removed(depth[static_cast<std::size_t>(v * width + u)]);
        hidden += is_hit(u, v);
        if (is_hit(u, v)) {
          ASSERT_TRUE(is_out) << u << ' ' << v;
        }
        bool is_beside = false;
        for (int dv = -3; dv <= 3; ++dv)
          for (int du = -3; du <= 3; ++du) is_beside |= is_hit(u + du, v + dv);
        // At the image's rim the solid may begin right outside of it; slender parts lie between
        // rays.
        const bool is_at_rim = u < 4 || v < 4 || u >= width - 4 || v >= height - 4;
        if (is_out && !is_at_rim && n % 5 < 3) {
          ASSERT_TRUE(is_beside) << u << ' ' << v;
        }
      }
  }
  EXPECT_GT(hidden, 15000);
  EXPECT_GT(crossing, 3);
}

// Removes a link that begins behind the camera, reaches far into the picture and is displaced by
// the margin. All of it goes, and what another solid of the same depths is elsewhere in the picture
// stays.
TEST(DepthRemover, RemovesALinkThroughTheCamerasPlane) {
  std::mt19937_64 random(13);
  const Solid link = synthetic::make_box(0.05, 0.06, 1.2);
  for (const double margin : {0.002, 0.01, 0.03})
    for (const double side : {-0.12, 0.1}) {
      SCOPED_TRACE(::testing::Message() << margin << ' ' << side);
      const Link stated{link, {{}, {side, 0.05, 0.4}}};
      const Link seen = displaced({stated}, margin, random).front();
      Rays rays(kCamera);
      add_solid(synthetic::make_box(9, 9, 0.1), test::at({0, 0, 2}), -1, kCamera, rays);
      add_solid(synthetic::make_cube(0.1), test::at({-2 * side, -0.1, 0.8}), -1, kCamera, rays);
      add_solid(seen.solid, seen.pose, 0, kCamera, rays);
      std::vector<float> depth = measured(rays, random);
      const std::vector<Surface> surface{test::surface(link)};
      const SolidPlace place{stated.pose, margin};
      DepthRemover(surface).remove({&place, 1}, kCamera, depth);
      std::size_t shown = 0, left = 0;
      for (std::size_t p = 0; p < depth.size(); ++p) {
        shown += shows(rays, p);
        left += shows(rays, p) && !is_removed(depth[p]);
      }
      EXPECT_GT(shown, 300);
      EXPECT_EQ(left, 0);
      EXPECT_LT(removed_in(depth), 4 * shown);
      EXPECT_GT(std::ranges::count_if(depth, [](float d) { return d > 0.7F && d < 0.8F; }), 100);
    }
}

TEST(DepthRemover, LeavesImagesWithoutTheSolidAlone) {
  std::mt19937_64 random(5);
  const std::vector<Link> links = arm();
  DepthRemover remover(surfaces_of(links));
  const std::vector<float> before = measured(rays_of({}), random);
  for (const Vec3 away :
       {Vec3{0, 0, -5}, Vec3{9, 0, 0}, Vec3{-9, 0, 0}, Vec3{0, 9, 0}, Vec3{0, -9, 0},
        Vec3{0, 0, 1e9}, Vec3{1e30, 0, 0}, Vec3{0, 0, -1e30}, Vec3{0, 0, 1e30}}) {
    std::vector<SolidPlace> places = places_of(links, 0.05);
    for (SolidPlace& place : places) place.to_world.translation = away + place.to_world.translation;
    std::vector<float> depth = before;
    const std::size_t removed = remover.remove(places, kCamera, depth);
    if (away.z < 1) {
      EXPECT_EQ(removed, 0);
    }
    EXPECT_LE(removed, 9);  // far before the camera all is a pixel or so
    for (const RemovedSolid& found : remover.found()) EXPECT_EQ(found.explained, 0);
  }
}

TEST(DepthRemover, TakesSolidsInAnyOrder) {
  std::mt19937_64 random(11);
  const std::vector<Link> links = arm();
  for (const double margin : {0.0, 0.003, 0.04}) {
    const std::vector<float> before = measured(rays_of(displaced(links, margin, random)), random);
    std::vector<float> expected = before, wrong = before;
    std::vector<SolidPlace> places = places_of(links, margin);
    for (std::size_t k = 0; k < places.size(); ++k) places[k].margin *= 1 + 0.1 * double(k);
    DepthRemover(surfaces_of(links)).remove(places, kCamera, expected);
    for (int n = 0; n < 5; ++n) {
      std::vector<std::size_t> order{0, 1, 2, 3, 4, 5, 6};
      std::ranges::shuffle(order, random);
      std::vector<Link> shuffled;
      std::vector<SolidPlace> at;
      for (const std::size_t k : order) shuffled.push_back(links[k]), at.push_back(places[k]);
      std::vector<float> depth = before;
      DepthRemover(surfaces_of(shuffled)).remove(at, kCamera, depth);
      for (std::size_t p = 0; p < depth.size(); ++p)
        ASSERT_TRUE(depth[p] == expected[p] && std::signbit(depth[p]) == std::signbit(expected[p]));
    }
  }
}

// A solid that is not where its pose says explains little, and is seen to do so.
TEST(DepthRemover, TellsAPoseThatIsWrong) {
  const std::vector<Link> links = arm();
  DepthRemover remover(surfaces_of(links));
  std::vector<float> depth(std::size_t{kCamera.width} * kCamera.height, 2.0F);
  remover.remove(places_of(links, 0.01), kCamera, depth);
  for (const RemovedSolid& found : remover.found()) {
    EXPECT_GT(found.in_view, 10);
    EXPECT_EQ(found.explained, 0);
  }
  // The camera is in the first link.
  std::vector<SolidPlace> places = places_of(links, 0);
  places[0].to_world.translation = {};
  remover.remove(places, kCamera, depth);
  EXPECT_TRUE(remover.found()[0].holds_camera);
  EXPECT_FALSE(remover.found()[1].holds_camera);
}

// The tool stands in its own picture: nothing of its place is free, and nothing is in its way,
// where the picture is late, too. However narrow it is, its place is not closed as a hole.
TEST(DepthRemover, LeavesTheToolsPlaceUnseen) {
  std::mt19937_64 random(9);
  for (const double edge : {0.15, 0.03}) {
    const Solid cube = synthetic::make_cube(edge);
    const std::vector<Surface> surface{test::surface(cube)};
    const ToolModel tool = testing::lattice_cube(edge, 8, 2);
    ToolQuery query(tool, {});
    DepthRemover remover(surface);
    for (int n = 0; n < 40; ++n) {
      SCOPED_TRACE(n);
      Pose pose = test::random_pose(random, 0.3);
      pose.translation.z += 1.2;
      const double margin = 0.01 * (n % 4);
      const Link link{cube, pose};
      Rays rays(kCamera);
      add_solid(synthetic::make_box(9, 9, 0.1), test::at({0, 0, 2}), -1, kCamera, rays);
      const Link seen = displaced({link}, margin, random).front();
      add_solid(seen.solid, seen.pose, 0, kCamera, rays);
      std::vector<float> depth = measured(rays, random);
      const auto ask = [&] {
        const AnyBody body(make_cloud({kCamera.width, kCamera.height, depth}, kCamera, {}));
        return query.run(body, pose);
      };
      if (margin == 0) {  // of itself
        EXPECT_GT(ask().volume, 0);
      }
      const SolidPlace place{pose, margin};
      remover.remove({&place, 1}, kCamera, depth);
      const Result result = ask();
      ASSERT_TRUE(result.visibility);
      EXPECT_EQ(result.volume, 0);
      EXPECT_NEAR(result.visibility->seen_free, 0, 1e-9);
      EXPECT_NEAR(result.visibility->unseen + result.visibility->out_of_view, 1, 1e-9);
    }
  }
}

TEST(DepthRemover, RefusesWhatIsNoPlace) {
  const std::vector<Link> links = arm();
  DepthRemover remover(surfaces_of(links));
  std::vector<float> depth(std::size_t{kCamera.width} * kCamera.height, 1.0F);
  const auto text = [&](const std::vector<SolidPlace>& places,
                        std::span<float> image) -> std::string {
    try {
      remover.remove(places, kCamera, image);
    } catch (const Error& fault) {
      return fault.what();
    }
    return "";
  };
  std::vector<SolidPlace> places = places_of(links, 0.01);
  EXPECT_EQ(text(places, depth), "");
  for (const double margin : {-1e-9, HUGE_VAL, std::nan("")}) {
    places[3].margin = margin;
    EXPECT_EQ(text(places, depth), "solid 3: the margin must be finite and not negative");
  }
  places[3].margin = 0;
  places[5].to_world.rotation.row0.x = 3;
  EXPECT_NE(text(places, depth).find("solid 5, pose: its rotation is"), std::string::npos);
  places.pop_back();
  EXPECT_EQ(text(places, depth), "the solids to remove: 6 places, but 7 solids");
  places = places_of(links, 0);
  EXPECT_NE(text(places, std::span(depth).first(7)).find("it has 7 values"), std::string::npos);
}

}  // namespace
}  // namespace vpm
