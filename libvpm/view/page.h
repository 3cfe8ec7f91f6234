// A page that shows a result: one HTML file that any browser opens without a network.
//
//   view::Page page("vpm-query", "bunny in desk.vpmc");
//   page.add_image("measured surface", images, {});
//   page.add_spheres({.name = "spheres", .spheres = spheres, ...});
//   page.write("pose.html");
//
// Tools hand over layers, numbers and charts; page.html and the scripts beside it draw them. Every
// text, names of files too, reaches the page as data and is shown as text. A page holds positions
// about its origin in 16 bits per axis, depths in 16 bits, states in 2 bits.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/box.h"
#include "libvpm/core/pose.h"
#include "libvpm/model/solid.h"
#include "libvpm/model/sphere.h"
#include "libvpm/view/packed.h"

namespace vpm::view {

// Throws Error(unavailable) where this build has no drawing library, and says how to get one.
void check_available();

// The most pixels of an image, or points of a cloud, that a page holds; of more, every n-th.
inline constexpr std::size_t kMostPixels = 400'000;
inline constexpr std::size_t kMostPoints = 300'000;
// The most triangles of a mesh; finer meshes are simplified by joining vertices.
inline constexpr std::size_t kMostTriangles = 60'000;

// Returns the name of a file as a page shows it: without folders; "-" is standard input.
std::string shown_name(const std::string& path);
// Returns the value with four digits, and its unit.
std::string with_unit(double value, const char* unit);
// Returns a volume, m³, in m³, cm³ or mm³, as the pages' tables write those of columns.
std::string volume_text(double volume);

struct ImageView {
  const DepthImage* depth = nullptr;
  Camera camera;
  std::vector<Vec3f> normals{};         // camera axes, one per pixel; none: the page estimates them
  std::vector<std::uint8_t> reasons{};  // below 4, one per pixel; none: nothing is told of them
};

struct MeshView {
  std::string name, color;
  const Solid* solid = nullptr;
  std::optional<std::size_t> body{};
  double opacity = 1;
  bool on = true;
  std::optional<std::size_t> step{};  // shown at this step only
};

struct SpheresView {
  std::string name;
  std::span<const Sphere> spheres;
  std::optional<std::size_t> body{};
  // A row of states per step (append_bits); without, colours say the radius.
  std::span<const std::uint8_t> states{};
  bool prefix = false;                 // step k shows the first k + 1
  std::optional<std::size_t> step{};   // shown at this step only
  std::optional<std::size_t> cells{};  // index from add_cells: a click shows the cell
};

struct LinesView {
  std::string name, color;
  std::vector<Vec3> ends;  // two per line
  std::size_t count = 0;   // number that the panel says: lines, holes, pairs
  bool marks = false;      // ends are shown as points too
  bool above = false;      // nothing hides them
  bool on = true;
  std::optional<std::size_t> step{};
};

// Holds `size` values for each step.
struct Column {
  std::string name, unit;  // unit: m, m3, m4, N, Nm, %, or "" for counts
  std::size_t size = 1;
  std::vector<float> values;
  std::optional<std::size_t> body{};
};

// Number of an image that a step shows which shows none.
inline constexpr std::uint32_t kNoImage = UINT32_MAX;

class Page {
 public:
  Page(std::string program, std::string title);

  void set_origin(Vec3 origin) { origin_ = origin; }  // before the first layer
  void set_up(Vec3 up);
  // Sets the text under the title, beside program and version, e.g. "refined, 1000 of 1000
  // spheres".
  void set_summary(std::string summary) { summary_ = std::move(summary); }
  void add_fact(const std::string& name, const std::string& value);
  void add_note(const std::string& text);

  // Adds a body and returns its number. `center` is its centre of mass in its own coordinates;
  // `poses` map them to the world, one per step, or one for all. Points of view look at the tools,
  // which come first, and not at the bodies of the scene.
  std::size_t add_body(const std::string& name, Vec3 center, double radius,
                       std::span<const Pose> poses, bool is_tool = true);
  std::size_t add_column(const Column& column);

  // Adds images of equal size, of which each step shows one. `of_step` has its number for each
  // step, or kNoImage for a step that shows none; where it is empty all steps show the first. One
  // pixel in `stride` is taken each way; 0 stands for the least stride that kMostPixels allows.
  void add_image(const std::string& name, std::span<const ImageView> images,
                 std::span<const std::uint32_t> of_step, bool by_normal = false,
                 std::uint32_t stride = 0);
  void add_points(const std::string& name, const Cloud& cloud, bool by_normal = false);
  void add_mesh(const MeshView& mesh);
  void add_spheres(const SpheresView& spheres);
  void add_lines(const LinesView& lines);
  // Adds places of which each is shown before its step `until`.
  void add_dust(const std::string& name, const std::string& color, std::span<const Vec3> places,
                std::span<const std::uint32_t> until);
  // Adds the places of a body's centre at its poses, joined by lines if they follow each other.
  void add_path(const std::string& name, const std::string& color, std::size_t body,
                bool is_joined = true);
  void add_arrow(const std::string& name, const std::string& color, std::size_t body,
                 std::size_t column, bool ring);
  // Adds the samples, m, of the Voronoi cells of spheres, and returns the number by which layers of
  // spheres name them. Sphere k has samples[begin[k]] to samples[begin[k + 1] - 1].
  std::size_t add_cells(std::span<const std::uint32_t> begin, std::span<const Vec3> samples);

  // Returns what main.js knows of the steps: {"name", "count", "start", ...}.
  Json& steps() { return steps_; }
  void add_chart(Json chart) { charts_.push_back(std::move(chart)); }
  void set_views(std::vector<std::string> names) { views_ = std::move(names); }

  std::string html() const;
  // Writes the page, replacing a file in one step; "-" is standard output. Throws
  // Error(cannot_write), and what check_available() throws.
  void write(const std::string& path) const;

 private:
  Vec3 place(Vec3 world);
  Json image_of(const ImageView& image, std::uint32_t stride);

  std::string program_, title_, summary_;
  Vec3 origin_, up_{0, 0, 1};
  Box box_;  // bounds what is shown, about the origin
  Json facts_ = Json::array(), notes_ = Json::array(), bodies_ = Json::array(),
       columns_ = Json::array(), layers_ = Json::array(), charts_ = Json::array(),
       cells_ = Json::array();
  Json steps_{{"name", "step"}, {"count", 0}, {"start", 0}};
  std::vector<std::string> views_{"all"};
};

// The page's text before and after its data: page.html, the scripts and the drawing library, put
// together when vpm is built (embed.cmake). Both are empty in a build without the drawing library.
extern const std::string_view kPageHead, kPageTail;

}  // namespace vpm::view
