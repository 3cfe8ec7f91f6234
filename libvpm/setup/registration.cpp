#include "libvpm/setup/registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/core/median.h"
#include "libvpm/core/parallel.h"
#include "libvpm/scene/rig/clear_pixel.h"
#include "libvpm/scene/rig/prepared_rig.h"

namespace vpm {
namespace {

constexpr double kSurelySame = 0.01;  // per depth: never less is
constexpr int kSteps = 12;
constexpr std::size_t kMotions = 6;  // of a camera: along and about three axes

// A camera in the frame of the first one: its place and motion there, and what it shows.
struct MovedCamera {
  DepthSurface image;
  Pose start, to_rig;         // as it is told, and as it is moved
  std::vector<Vec3> places;   // that clear pixels show, the camera's frame
  std::vector<Vec3> normals;  // their unit normals, the camera's frame
  double depth = 0;           // m, greatest median of what a camera shows: the same for all
  std::array<double, 6> correction{};  // by which it is moved, along and about the rig's axes, in
                                       // units of what is expected of a camera
};

MovedCamera moved_camera(const DepthBody& body, const Pose& rig) {
  const Pose to_rig = relative_to(rig, body.to_world());
  MovedCamera camera{body.surface(), to_rig, to_rig, {}, {}, 0, {}};
  const DepthSurface& image = camera.image;
  std::vector<double> depths;
  for_clear_pixels(image, step_of_comparison(image),
                   [&](std::int32_t u, std::int32_t v, const Vec3& at) {
                     const Vec3 normal = widen(image.normals[v * image.width + u]);
                     if (!(-dot(normal, at) > kFrontal * norm(at))) return;
                     camera.places.push_back(at);
                     camera.normals.push_back(normal);
                     depths.push_back(at.z);
                   });
  if (!depths.empty()) camera.depth = median(depths);
  return camera;
}

// What camera `other` sees at a place that camera `own` shows, the rig's frame.
struct Reading {
  std::size_t own = 0, other = 0;
  Vec3 place, normal;           // the normal is the other's
  double depth = 0, apart = 0;  // m; the second is along the normal
  double unlike = 0;            // 1 minus the cosine between both cameras' normals
};

// Returns the readings of places that one camera shows by all others, which differ by at most
// `most` of the depth.
std::vector<Reading> readings_of(const std::vector<MovedCamera>& cameras, std::size_t own,
                                 double most) {
  std::vector<Reading> readings;
  const MovedCamera& shows = cameras[own];
  for (std::size_t other = 0; other < cameras.size(); ++other) {
    if (other == own) continue;
    const MovedCamera& sees = cameras[other];
    const Pose to_other = relative_to(sees.to_rig, shows.to_rig);
    for (std::size_t k = 0; k < shows.places.size(); ++k) {
      const Vec3 at = to_other * shows.places[k];
      if (!(at.z > 0)) continue;
      const SurfaceSample seen = sees.image.sample(at);
      const double depth = std::max(shows.places[k].z, at.z);
      const double cosine = dot(seen.normal, to_other.rotation * shows.normals[k]);
      if (!(seen.known && std::fabs(seen.distance) <= most * depth && cosine > kAlikeNormals &&
            -dot(seen.normal, at) > kFrontal * norm(at)))
        continue;
      readings.push_back({own, other, shows.to_rig * shows.places[k],
                          sees.to_rig.rotation * seen.normal, depth, seen.distance, 1 - cosine});
    }
  }
  return readings;
}

// Returns the same of all cameras, in their order.
std::vector<Reading> all_readings(const std::vector<MovedCamera>& cameras, double most) {
  std::vector<std::vector<Reading>> of_cameras(cameras.size());
  parallel_for(cameras.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t own = begin; own < end; ++own)
      of_cameras[own] = readings_of(cameras, own, most);
  });
  std::vector<Reading> all;
  for (const std::vector<Reading>& some : of_cameras)
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

// Returns the robust deviation of readings, m, or per depth.
double deviation_of(const std::vector<Reading>& readings, bool is_per_depth) {
  std::vector<double> apart;
  for (const Reading& reading : readings)
    apart.push_back(std::fabs(reading.apart) / (is_per_depth ? reading.depth : 1));
  return apart.empty() ? 0 : kDeviationOfMedian * median(apart);
}

// Returns the robust variance of normals, rad^2, along each of two axes.
double noise_of_normals(const std::vector<Reading>& readings) {
  constexpr double kOfMedian = 0.72;  // of half the squared angle between two normals
  std::vector<double> unlike;
  for (const Reading& reading : readings) unlike.push_back(reading.unlike);
  return unlike.empty() ? 0 : kOfMedian * median(unlike);
}

// A symmetric matrix, row by row, and a vector: the information that readings give of all motions,
// and their pull.
struct Equations {
  std::size_t size = 0;
  std::vector<double> matrix, pull;
};

// Returns the derivatives of how far a reading is apart, per depth, by the motions of a camera.
std::array<double, kMotions> slopes(const Reading& reading, const MovedCamera& camera,
                                    double expected) {
  const Vec3 along = camera.depth * reading.normal,
             about = cross(reading.place - camera.to_rig.translation, reading.normal);
  std::array<double, kMotions> slope{along.x, along.y, along.z, about.x, about.y, about.z};
  for (double& one : slope) one *= expected / reading.depth;
  return slope;
}

// Returns the equations of least squares: each reading counts by its distance (Tukey's biweight)
// in units of the deviation. `expected` is what is expected of a camera's error, per depth and
// radian, and the unit of motions.
Equations equations_of(const std::vector<Reading>& readings,
                       const std::vector<MovedCamera>& cameras, double expected, double deviation) {
  constexpr double kBeyond = 4.7;  // deviations: is an outlier
  constexpr double kOfOwn = 0.25;  // what a reading tells that its neighbours do not
  Equations all{kMotions * cameras.size(), {}, {}};
  all.matrix.assign(all.size * all.size, 0);
  all.pull.assign(all.size, 0);
  for (const Reading& reading : readings) {
    const double apart = reading.apart / reading.depth, part = apart / (kBeyond * deviation);
    const double rest = 1 - part * part;
    if (rest <= 0) continue;
    const double weight = kOfOwn * rest * rest / (deviation * deviation);
    const auto own = slopes(reading, cameras[reading.own], expected),
               other = slopes(reading, cameras[reading.other], expected);
    std::array<std::pair<std::size_t, double>, 2 * kMotions> row;
    for (std::size_t k = 0; k < kMotions; ++k) {
      row[k] = {kMotions * reading.own + k, own[k]};
      row[kMotions + k] = {kMotions * reading.other + k, -other[k]};
    }
    for (const auto& [i, slope] : row) {
      all.pull[i] -= weight * slope * apart;
      for (const auto& [j, by] : row) all.matrix[i * all.size + j] += weight * slope * by;
    }
  }
  return all;
}

// Diagonalises a symmetric matrix of n rows by Jacobi's rotations. Returns its eigenvectors, as
// columns.
std::vector<double> diagonalise(std::size_t n, std::vector<double>& a) {
  constexpr int kSweeps = 30;
  constexpr double kNothing = 1e-15;  // of the diagonal
  std::vector<double> vectors(n * n, 0);
  for (std::size_t i = 0; i < n; ++i) vectors[i * n + i] = 1;
  bool is_done = false;
  for (int sweep = 0; sweep < kSweeps && !is_done; ++sweep) {
    is_done = true;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        const double off = a[p * n + q], difference = a[q * n + q] - a[p * n + p];
        if (std::fabs(off) <= kNothing * (a[p * n + p] + a[q * n + q])) continue;
        is_done = false;
        const double tangent =
            2 * off / (difference + std::copysign(std::hypot(difference, 2 * off), difference));
        const double c = 1 / std::hypot(1, tangent), s = tangent * c;
        const auto turn = [&](double& x, double& y) {
          const double before = x;
          x = c * before - s * y, y = s * before + c * y;
        };
        for (std::size_t k = 0; k < n; ++k) turn(a[k * n + p], a[k * n + q]);
        for (std::size_t k = 0; k < n; ++k) turn(a[p * n + k], a[q * n + k]);
        for (std::size_t k = 0; k < n; ++k) turn(vectors[k * n + p], vectors[k * n + q]);
      }
    }
  }
  return vectors;
}

// Solves the equations together with what is expected of cameras, one unit for each motion, along
// each eigenvector of the information by itself. Not observable is one whose information is no more
// than normals of this variance, rad^2, give where surfaces slide on themselves: along it cameras
// go back to where they started. So does a motion of all cameras together. Returns the number of
// observable ones, and the longest step, in the unit of motions.
std::pair<std::size_t, double> step_by(Equations equations, double expected, double noise,
                                       std::vector<MovedCamera>& cameras) {
  constexpr double kOfNoise = 4;
  const std::size_t n = equations.size;
  const std::vector<double> vectors = diagonalise(n, equations.matrix);
  double greatest = 0;
  for (std::size_t k = 0; k < n; ++k) greatest = std::max(greatest, equations.matrix[k * n + k]);
  std::vector<double> step(n, 0);
  std::size_t observable = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double information = equations.matrix[k * n + k];
    const bool is_observable = information > std::max(1.0, kOfNoise * noise * greatest);
    observable += is_observable;
    double pull = 0;
    for (std::size_t i = 0; i < n; ++i)
      pull += vectors[i * n + k] * ((is_observable ? equations.pull[i] : 0) -
                                    cameras[i / kMotions].correction[i % kMotions]);
    const double by = is_observable ? pull / (information + 1) : pull;
    for (std::size_t i = 0; i < n; ++i) step[i] += by * vectors[i * n + k];
  }
  double longest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    cameras[i / kMotions].correction[i % kMotions] += step[i];
    longest = std::max(longest, std::fabs(step[i]));
  }
  for (MovedCamera& camera : cameras) {
    const auto& by = camera.correction;
    camera.to_rig = {
        rotation_from_vector(expected * Vec3{by[3], by[4], by[5]}) * camera.start.rotation,
        camera.start.translation + expected * camera.depth * Vec3{by[0], by[1], by[2]}};
  }
  return {observable, longest};
}

// Throws Error(refused) if a camera shares too little with all others; `names` are the places of
// cameras in the caller's list.
void check_shared(const std::vector<Reading>& readings, const std::vector<std::size_t>& names) {
  std::vector<std::size_t> shared(names.size(), 0);
  for (const Reading& reading : readings) ++shared[reading.own], ++shared[reading.other];
  const auto least = std::ranges::min_element(shared);
  if (*least >= kFewReadings) return;
  const std::size_t camera = names[static_cast<std::size_t>(least - shared.begin())];
  refuse("it shows hardly a surface that another one shows too, within " +
             std::to_string(static_cast<int>(100 * kSameSurface)) +
             " % of the depth: nothing tells where its camera is",
         "image " + std::to_string(camera + 1) + " of the list",
         "leave it out, or calibrate its camera");
}

// Returns the smallest deviation that pixels of images resolve, per depth.
double finest_of(const std::vector<MovedCamera>& cameras) {
  constexpr double kOfPixel = 0.1;
  double width = 0;
  for (const MovedCamera& camera : cameras)
    width = std::max(width, 1 / std::min(camera.image.k.fx, camera.image.k.fy));
  return kOfPixel * width;
}

// Moves the cameras until the images agree. Returns the rest of a Registration than the poses.
Registration moved_to_agree(std::vector<MovedCamera>& cameras,
                            const std::vector<std::size_t>& names) {
  constexpr double kOfDeviation = 1 / 1.5;  // errors of two cameras add up to 1.5 times one's
  constexpr double kShort = 1e-3;           // in units of what is expected
  Registration found;
  std::vector<Reading> readings = all_readings(cameras, kSameSurface);
  check_shared(readings, names);
  const std::size_t first_count = readings.size();
  found.before = deviation_of(readings, false);
  const double finest = finest_of(cameras);
  double deviation = std::max(deviation_of(readings, true), finest);
  const double expected = kOfDeviation * deviation;
  for (int step = 0; step < kSteps; ++step) {
    const auto [observable, longest] = step_by(equations_of(readings, cameras, expected, deviation),
                                               expected, noise_of_normals(readings), cameras);
    found.observable = observable;
    if (longest < kShort) break;
    readings = all_readings(cameras, std::clamp(6 * deviation, kSurelySame, kSameSurface));
    deviation = std::max(deviation_of(readings, true), finest);
  }
  // Cameras that lost sight of each other agree in nothing.
  const std::vector<Reading> now = all_readings(cameras, kSameSurface);
  found.after = 2 * now.size() < first_count ? HUGE_VAL : deviation_of(now, false);
  return found;
}

}  // namespace

Registration register_images(std::span<const DepthBody> images) {
  const std::vector<DepthBody> different = different_images({images.begin(), images.end()});
  std::vector<std::size_t> names(different.size()), place_of(images.size());
  for (std::size_t i = images.size(); i-- > 0;) {
    const auto is_it = [&](const DepthBody& body) {
      return different_images({body, images[i]}).size() == 1;
    };
    place_of[i] =
        static_cast<std::size_t>(std::ranges::find_if(different, is_it) - different.begin());
    names[place_of[i]] = i;
  }
  if (different.size() < 2)
    refuse("all images are of one camera, which agrees with itself", {},
           "give images of several cameras");
  const Pose rig = different.front().to_world();
  std::vector<MovedCamera> cameras;
  for (const DepthBody& body : different) cameras.push_back(moved_camera(body, rig));
  double depth = 0;
  for (const MovedCamera& camera : cameras) depth = std::max(depth, camera.depth);
  for (MovedCamera& camera : cameras) camera.depth = depth;
  Registration found = moved_to_agree(cameras, names);
  found.motions = kMotions * (different.size() - 1);
  const bool is_better = found.after < found.before;
  if (!is_better) found.after = found.before, found.observable = 0;
  for (const std::size_t place : place_of) {
    const MovedCamera& camera = cameras[place];
    const Pose& told = different[place].to_world();
    const Rotation turn = camera.to_rig.rotation * transpose(camera.start.rotation);
    found.to_world.push_back(
        is_better
            ? Pose{exact_rotation(rig.rotation * turn * transpose(rig.rotation) * told.rotation),
                   told.translation +
                       rig.rotation * (camera.to_rig.translation - camera.start.translation)}
            : told);
  }
  return found;
}

}  // namespace vpm
