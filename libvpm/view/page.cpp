#include "libvpm/view/page.h"

#include <vpm/version.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/view/simplify.h"
#include "libvpm/view/sphere_files.h"

namespace vpm::view {
namespace {

// Depths beyond this many times the 98 % quantile are strays, which a page leaves out.
constexpr double kStray = 3;

Json as_json(Vec3 v) {
  return {v.x, v.y, v.z};
}

void append(std::vector<float>& numbers, const Pose& pose, Vec3 origin) {
  const Vec3 t = pose.translation - origin;
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  for (const double x : {t.x, t.y, t.z, q.x, q.y, q.z, q.w})
    numbers.push_back(static_cast<float>(x));
}

Json packed_pose(const Pose& pose, Vec3 origin) {
  std::vector<float> numbers;
  append(numbers, pose, origin);
  return numbers;
}

std::string hex(const std::array<std::uint8_t, 3>& rgb) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
  return text;
}

// Nothing in a script element ends it but "</", and no JSON needs a "<".
std::string without_markup(std::string json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

struct DepthRange {
  double low = 0, high = 0, median = 0;
};

DepthRange range_of(const DepthImage& image) {
  std::vector<float> depths;
  for (const float d : image.depth)
    if (is_measured(d)) depths.push_back(d);
  if (depths.empty()) return {0, 1, 1};
  const auto quantile = [&](double fraction) {
    const auto at = depths.begin() +
                    static_cast<std::ptrdiff_t>(fraction * static_cast<double>(depths.size() - 1));
    std::nth_element(depths.begin(), at, depths.end());
    return static_cast<double>(*at);
  };
  DepthRange range{0, kStray * quantile(0.98), quantile(0.5)};
  double highest = 0;
  range.low = range.high;
  for (const double d : depths) {
    range.low = std::min(range.low, d);
    if (d <= range.high) highest = std::max(highest, d);
  }
  range.high = highest;
  return range;
}

// Returns the side of the squares of pixels of which one is kept.
std::uint32_t stride_for(const DepthImage& image, std::size_t most) {
  std::uint32_t stride = 1;
  while ((image.width / stride) * std::size_t{image.height / stride} > most) ++stride;
  return stride;
}

}  // namespace

void check_available() {
  if (kPageHead.empty())
    throw Error(ErrorKind::unavailable,
                "this build draws no pages, because three.js was not found; install it "
                "(Debian: libjs-three) and build again");
}

std::string shown_name(const std::string& path) {
  return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

std::string with_unit(double value, const char* unit) {
  char text[64];
  std::snprintf(text, sizeof text, "%.4g %s", value, unit);
  return text;
}

std::string volume_text(double volume) {
  if (volume >= 1) return with_unit(volume, "m³");
  return volume >= 1e-6 ? with_unit(1e6 * volume, "cm³") : with_unit(1e9 * volume, "mm³");
}

Page::Page(std::string program, std::string title)
    : program_(std::move(program)), title_(std::move(title)) {}

void Page::set_up(Vec3 up) {
  if (const Vec3 unit = normalized_or_zero(up); squared_norm(unit) > 0) up_ = unit;
}

void Page::add_fact(const std::string& name, const std::string& value) {
  facts_.push_back({name, value});
}

void Page::add_note(const std::string& text) {
  notes_.push_back(text);
}

Vec3 Page::place(Vec3 world) {
  const Vec3 at = world - origin_;
  box_.add(at);
  return at;
}

std::size_t Page::add_body(const std::string& name, Vec3 center, double radius,
                           std::span<const Pose> poses, bool is_tool) {
  std::vector<float> numbers;
  for (const Pose& pose : poses) {
    append(numbers, pose, origin_);
    const Vec3 at = pose * center;
    place(at - Vec3{radius, radius, radius});
    place(at + Vec3{radius, radius, radius});
  }
  bodies_.push_back({{"name", name},
                     {"center", as_json(center)},
                     {"radius", radius},
                     {"is_tool", is_tool},
                     {"poses", packed(std::span<const float>(numbers))}});
  return bodies_.size() - 1;
}

std::size_t Page::add_column(const Column& column) {
  columns_.push_back({{"name", column.name},
                      {"unit", column.unit},
                      {"size", column.size},
                      {"body", column.body ? static_cast<int>(*column.body) : -1},
                      {"values", packed(std::span<const float>(column.values))}});
  return columns_.size() - 1;
}

Json Page::image_of(const ImageView& view, std::uint32_t stride) {
  const DepthImage& image = *view.depth;
  const DepthRange range = range_of(image);
  const std::uint32_t width = (image.width + stride - 1) / stride;
  const std::uint32_t height = (image.height + stride - 1) / stride;
  std::vector<std::uint16_t> steps;
  std::vector<Vec3f> normals;
  std::vector<std::uint8_t> reasons;
  std::vector<std::uint32_t> removed;  // pixels that show a known solid, by their number
  const double step = std::max(range.high - range.low, 1e-30) / 65534;
  for (std::uint32_t v = 0; v < image.height; v += stride) {
    for (std::uint32_t u = 0; u < image.width; u += stride) {
      const std::size_t k = image.index(u, v);
      const double d = image.depth[k];
      const bool shown = is_measured(image.depth[k]) && d <= range.high;
      if (is_removed(image.depth[k])) removed.push_back(static_cast<std::uint32_t>(steps.size()));
      steps.push_back(shown ? static_cast<std::uint16_t>(1 + std::lround((d - range.low) / step))
                            : 0);
      if (!view.normals.empty()) normals.push_back(view.normals[k]);
      if (!view.reasons.empty()) reasons.push_back(view.reasons[k]);
      if (shown && (u / stride) % 4 == 0 && (v / stride) % 4 == 0)
        place(view.camera.to_world * unproject(view.camera.intrinsics, u, v, d));
    }
  }
  const Intrinsics& k = view.camera.intrinsics;
  Json json{{"width", width},
            {"height", height},
            {"step", stride},
            {"intrinsics", {k.fx / stride, k.fy / stride, k.cx / stride, k.cy / stride}},
            {"pose", packed_pose(view.camera.to_world, origin_)},
            {"low", range.low},
            {"high", range.high},
            {"median", range.median},
            {"depth", packed(std::span<const std::uint16_t>(steps))}};
  if (!normals.empty()) json["normals"] = packed_normals(normals);
  if (!removed.empty()) json["removed"] = packed(std::span<const std::uint32_t>(removed));
  if (!reasons.empty()) {
    std::vector<std::uint8_t> bits;
    append_bits(reasons, bits);
    json["reasons"] = packed(std::span<const std::uint8_t>(bits));
  }
  return json;
}

void Page::add_image(const std::string& name, std::span<const ImageView> images,
                     std::span<const std::uint32_t> of_step, bool by_normal, std::uint32_t stride) {
  Json layer{{"type", "image"}, {"name", name}, {"images", Json::array()}};
  if (by_normal) layer["by"] = "normal";
  if (!of_step.empty()) layer["of_step"] = packed(of_step);
  for (const ImageView& image : images) {
    const std::uint32_t every = stride > 0 ? stride : stride_for(*image.depth, kMostPixels);
    layer["images"].push_back(image_of(image, every));
    if (every > 1 && &image == &images.front())
      add_fact("shown", "one pixel in " + std::to_string(every) + " each way");
  }
  layers_.push_back(std::move(layer));
}

void Page::add_points(const std::string& name, const Cloud& cloud, bool by_normal) {
  const std::size_t every = (cloud.size() + kMostPoints - 1) / kMostPoints;
  std::vector<Vec3> positions;
  std::vector<Vec3f> normals;
  for (std::size_t k = 0; k < cloud.size(); k += every) {
    positions.push_back(place(cloud.origin + widen(cloud.positions[k])));
    normals.push_back(cloud.normals[k]);
  }
  if (every > 1) add_fact("shown", "one point in " + std::to_string(every));
  Json layer{{"type", "points"},
             {"name", name},
             {"positions", packed_positions(positions)},
             {"normals", packed_normals(normals)}};
  if (by_normal) layer["by"] = "normal";
  layers_.push_back(std::move(layer));
}

void Page::add_mesh(const MeshView& view) {
  const Solid solid = simplified(*view.solid, kMostTriangles);
  std::vector<Vec3> positions;
  for (const Vec3& p : solid.vertices) positions.push_back(view.body ? p : place(p));
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : solid.triangles) corners.insert(corners.end(), t.begin(), t.end());
  Json layer{{"type", "mesh"},      {"name", view.name},
             {"color", view.color}, {"opacity", view.opacity},
             {"on", view.on},       {"positions", packed_positions(positions)}};
  if (solid.vertices.size() <= 65535) {
    const std::vector<std::uint16_t> narrow(corners.begin(), corners.end());
    layer["indices"] = packed(std::span<const std::uint16_t>(narrow));
  } else {
    layer["indices"] = packed(std::span<const std::uint32_t>(corners));
  }
  if (view.body) layer["body"] = *view.body;
  if (view.step) layer["step"] = *view.step;
  layers_.push_back(std::move(layer));
}

void Page::add_spheres(const SpheresView& view) {
  std::vector<Vec3> centers;
  std::vector<float> radii;
  for (const Sphere& s : view.spheres) {
    centers.push_back(view.body ? s.center : place(s.center));
    radii.push_back(static_cast<float>(s.radius));
  }
  Json layer{{"type", "spheres"},
             {"name", view.name},
             {"on", true},
             {"centers", packed_positions(centers)},
             {"radii", packed(std::span<const float>(radii))}};
  if (!view.states.empty()) layer["states"] = packed(view.states);
  if (view.prefix) layer["prefix"] = true;
  if (view.body) layer["body"] = *view.body;
  if (view.step) layer["step"] = *view.step;
  if (view.cells) layer["cells"] = *view.cells;
  layers_.push_back(std::move(layer));
}

void Page::add_lines(const LinesView& view) {
  std::vector<Vec3> ends;
  for (const Vec3& p : view.ends) ends.push_back(place(p));
  Json layer{{"type", "lines"},     {"name", view.name},
             {"color", view.color}, {"count", view.count},
             {"marks", view.marks}, {"above", view.above},
             {"on", view.on},       {"positions", packed_positions(ends)}};
  if (view.step) layer["step"] = *view.step;
  layers_.push_back(std::move(layer));
}

void Page::add_dust(const std::string& name, const std::string& color, std::span<const Vec3> places,
                    std::span<const std::uint32_t> until) {
  std::vector<Vec3> positions;
  for (const Vec3& p : places) positions.push_back(place(p));
  layers_.push_back({{"type", "dust"},
                     {"name", name},
                     {"color", color},
                     {"on", true},
                     {"positions", packed_positions(positions)},
                     {"until", packed(until)}});
}

void Page::add_path(const std::string& name, const std::string& color, std::size_t body,
                    bool is_joined) {
  layers_.push_back({{"type", "path"},
                     {"name", name},
                     {"color", color},
                     {"body", body},
                     {"joined", is_joined},
                     {"on", true}});
}

void Page::add_arrow(const std::string& name, const std::string& color, std::size_t body,
                     std::size_t column, bool ring) {
  layers_.push_back({{"type", "arrow"},
                     {"name", name},
                     {"color", color},
                     {"body", body},
                     {"column", column},
                     {"ring", ring},
                     {"on", true}});
}

std::size_t Page::add_cells(std::span<const std::uint32_t> begin, std::span<const Vec3> samples) {
  std::vector<Vec3> positions;
  for (const Vec3& p : samples) positions.push_back(p - origin_);
  cells_.push_back({{"begin", packed(begin)}, {"positions", packed_positions(positions)}});
  return cells_.size() - 1;
}

std::string Page::html() const {
  check_available();
  const bool is_empty = !(box_.low.x <= box_.high.x);
  const Vec3 center = is_empty ? Vec3{} : 0.5 * (box_.low + box_.high);
  const double radius = is_empty ? 1 : std::max(0.5 * norm(box_.size()), 1e-9);
  Json document{{"program", program_}, {"version", VPM_VERSION},    {"title", title_},
                {"summary", summary_}, {"facts", facts_},           {"notes", notes_},
                {"up", as_json(up_)},  {"center", as_json(center)}, {"radius", radius}};
  Json colors;
  for (const StateLook& look : kStateLooks) colors[look.name] = hex(look.rgb);
  document["colors"] = std::move(colors);
  document["steps"] = steps_;
  document["views"] = views_;
  document["bodies"] = bodies_;
  document["columns"] = columns_;
  document["layers"] = layers_;
  document["charts"] = charts_;
  if (!cells_.empty()) document["cells"] = cells_;
  const std::string data =
      without_markup(document.dump(-1, ' ', false, Json::error_handler_t::replace));
  return std::string(kPageHead) + data + std::string(kPageTail);
}

void Page::write(const std::string& path) const {
  file::write_all(path, html());
}

}  // namespace vpm::view
