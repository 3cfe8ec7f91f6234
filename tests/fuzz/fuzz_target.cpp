#include "tests/fuzz/fuzz_target.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "libvpm/core/error.h"
#include "tests/fuzz/targets.h"

namespace vpm::fuzz {
namespace {

constexpr Target kTargets[] = {
#ifdef VPM_FUZZ_SOLID
    {"obj", run_obj},
    {"off", run_off},
    {"ply", run_ply},
    {"stl", run_stl},
    {"om", run_om},
    {"scene", run_scene, nullptr, true},
    {"threemf", run_threemf},
    {"solid", run_solid},
    {"vpmp", run_vpmp, mutate_container},
#endif
    {"png", run_png},
#ifdef VPM_FUZZ_EXR
    {"exr", run_exr},
#endif
    {"tiff", run_tiff},
    {"netpbm", run_netpbm},
    {"npy", run_npy},
    {"pcd", run_pcd},
    {"ply_points", run_ply_points},
    {"vpmg", run_vpmg, mutate_container},
    {"vpmc", run_vpmc, mutate_container},
    {"container", run_container},
    {"poses", run_poses},
    {"camera_pose", run_camera_pose},
    {"intrinsics", run_intrinsics},
    {"config", run_config},
    {"options", run_options},
    {"recording", run_recording},
    {"mcap", run_mcap},
};

bool is_on_one_line(const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') return false;
  return true;
}

}  // namespace

std::span<const Target> all_targets() {
  return kTargets;
}

const Target* find_target(std::string_view name) {
  for (const Target& target : kTargets)
    if (target.name == name) return &target;
  return nullptr;
}

void run_in_time(const Target& target, Bytes input) {
  const std::clock_t start = std::clock();
  target.run(input);
  const double taken = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  if (taken > kMostSeconds) fail("it takes " + std::to_string(taken) + " s");
}

void fail(const std::string& promise) {
  std::fprintf(stderr, "broken promise: %s\n", promise.c_str());
  std::abort();
}

void expect_error_at_most(const std::function<void()>& reader) {
  constexpr std::size_t kLongestMessage = 1500;
  try {
    reader();
  } catch (const Error& fault) {
    const std::string message = fault.what();
    if (message.empty()) fail("an Error has no message");
    if (!is_on_one_line(message)) fail("a message has control characters: " + message);
    if (message.size() > kLongestMessage)
      fail("a message of " + std::to_string(message.size()) + " bytes");
  }
}

void expect_finite(const Pose& pose) {
  for (const Vec3& v :
       {pose.rotation.row0, pose.rotation.row1, pose.rotation.row2, pose.translation})
    if (!is_finite(v)) fail("a pose is not finite");
}

const std::string& path_of(Bytes bytes) {
  static const int file = ::memfd_create("input", 0);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  const auto size = static_cast<ssize_t>(bytes.size());
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, bytes.data(), bytes.size(), 0) != size)
    fail("no file in memory");
  return path;
}

}  // namespace vpm::fuzz
