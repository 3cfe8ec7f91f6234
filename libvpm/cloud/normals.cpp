#include "libvpm/cloud/normals.h"

#include <algorithm>
#include <cmath>

#include "libvpm/cloud/normal_rows.h"
#include "libvpm/cloud/row_bands.h"
#include "libvpm/cloud/window_span.h"
#include "libvpm/core/error.h"
#include "libvpm/core/lanes.h"

namespace vpm {
namespace {

// Cosine between normal and ray (84 degrees) below which disks grow no further: there the normal's
// error would decide their size, not the surface.
constexpr double kGrazingCosine = 0.1;

float disk_radius(const Intrinsics& k, Vec3 point, Vec3 normal) {
  const double half_diagonal = 0.5 * std::sqrt(1 / (k.fx * k.fx) + 1 / (k.fy * k.fy));
  const double cosine = -dot(point, normal) / norm(point);
  return static_cast<float>(point.z * half_diagonal / std::max(cosine, kGrazingCosine));
}

VPM_VECTOR_CLONES
void store_normals(const NormalRow& row, Vec3f* to) {
  const float *x = row.x.data(), *y = row.y.data(), *z = row.z.data();
  for (std::size_t u = 0; u < row.width; ++u) to[u] = {x[u], y[u], z[u]};
}

}  // namespace

void NormalImages::resize(std::uint32_t width, std::uint32_t height, const NormalOptions& options) {
  inverse.resize(width, height, options.window / 2, kBeyondImage);
  if (options.method == NormalMethod::pca) depth.resize(width, height, options.window / 2);
}

void NormalImages::take_rows(const DepthImage& image, const NormalOptions& options, int begin,
                             int end) {
  take_inverse_depth(image, begin, end, inverse);
  if (options.method == NormalMethod::pca) take_depth(image, begin, end, depth);
}

std::unique_ptr<NormalRows> normal_rows(const NormalImages& images, const Intrinsics& k,
                                        const NormalOptions& options) {
  return options.method == NormalMethod::pca ? pca_rows(images, k, options)
                                             : inverse_depth_rows(images, k, options);
}

std::string to_text(NormalMethod method) {
  return method == NormalMethod::pca ? "pca" : "inverse-depth";
}

NormalMethod normal_method_from_text(const std::string& text) {
  if (text == "pca") return NormalMethod::pca;
  if (text == "inverse-depth") return NormalMethod::inverse_depth;
  throw Error(ErrorKind::invalid_argument, "unknown method '" + text + "'", "normals",
              "there are inverse-depth and pca");
}

void check_normal_options(const NormalOptions& options) {
  if (options.window < kMinWindow || options.window > kMaxWindow || options.window % 2 == 0) {
    throw Error(ErrorKind::invalid_argument,
                "the window must be odd and between " + std::to_string(kMinWindow) + " and " +
                    std::to_string(kMaxWindow) + " pixels, not " + std::to_string(options.window),
                "normals");
  }
  if (!(options.edge_gate >= 0 && options.edge_gate < 1))
    throw Error(ErrorKind::invalid_argument, "the edge gate must be at least 0 and less than 1",
                "normals");
}

void check_intrinsics(const Intrinsics& k) {
  if (!are_sound(k)) {
    throw Error(ErrorKind::invalid_argument,
                "intrinsics: fx,fy,cx,cy must be finite and within 2^40, fx and fy greater than 0 "
                "(pixels)");
  }
}

std::vector<Vec3f> estimate_normals(const DepthImage& depth, const Intrinsics& intrinsics,
                                    const NormalOptions& options) {
  check_normal_options(options);
  check_intrinsics(intrinsics);
  if (depth.depth.size() != std::size_t{depth.width} * depth.height) {
    refuse("the depth image has " + std::to_string(depth.depth.size()) + " values for a size of " +
               std::to_string(depth.width) + " x " + std::to_string(depth.height),
           "normals");
  }
  std::vector<Vec3f> normals(depth.depth.size());
  NormalImages images;
  images.resize(depth.width, depth.height, options);
  const auto height = static_cast<int>(depth.height);
  for_bands(height, [&](int begin, int end) { images.take_rows(depth, options, begin, end); });
  for_bands(height, [&](int begin, int end) {
    NormalBand band(images, intrinsics, options);
    for (int v = begin; v < end; ++v)
      store_normals(band.estimate(v), normals.data() + static_cast<std::size_t>(v) * depth.width);
  });
  return normals;
}

Cloud assemble_cloud(const DepthImage& depth, const Camera& camera,
                     const std::vector<Vec3f>& normals) {
  const auto exists = [](Vec3f n) { return n.x != 0 || n.y != 0 || n.z != 0; };
  std::vector<std::size_t> first(std::size_t{depth.height} + 1);
  for (std::size_t v = 0; v < depth.height; ++v) {
    const auto row = normals.begin() + static_cast<std::ptrdiff_t>(v * depth.width);
    first[v + 1] =
        first[v] + static_cast<std::size_t>(std::count_if(row, row + depth.width, exists));
  }
  Cloud cloud;
  cloud.origin = camera.to_world.translation;
  cloud.positions.resize(first.back());
  cloud.normals.resize(first.back());
  cloud.radii.resize(first.back());
  cloud.pixels.resize(first.back());
  cloud.sensor = CloudSensor{camera, depth};
  const Rotation& rotation = camera.to_world.rotation;
  for_bands(static_cast<int>(depth.height), [&](int begin, int end) {
    std::size_t k = first[static_cast<std::size_t>(begin)];
    for (auto v = static_cast<std::size_t>(begin); v < static_cast<std::size_t>(end); ++v) {
      for (std::size_t i = v * depth.width; i < (v + 1) * depth.width; ++i) {
        cloud.sensor->depth.depth[i] = kept_depth(depth.depth[i]);
        if (!exists(normals[i])) continue;
        const Vec3 normal = widen(normals[i]);
        const double x = static_cast<double>(i - v * depth.width), y = static_cast<double>(v);
        const Vec3 point = unproject(camera.intrinsics, x, y, depth.depth[i]);
        cloud.positions[k] = position_of_pixel(camera, x, y, depth.depth[i]);
        cloud.normals[k] = narrow(rotation * normal);
        cloud.radii[k] = disk_radius(camera.intrinsics, point, normal);
        cloud.pixels[k] = static_cast<std::uint32_t>(i);
        ++k;
      }
    }
  });
  return cloud;
}

Cloud make_cloud(const DepthImage& depth, const Camera& camera, const NormalOptions& options) {
  return assemble_cloud(depth, camera, estimate_normals(depth, camera.intrinsics, options));
}

}  // namespace vpm
