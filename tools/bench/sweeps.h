// Sweeps of tools into scenes: both measures against the truth.
#pragma once

#include <vpm/query_types.h>

#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libvpm/device/device.h"
#include "tools/bench/errors.h"
#include "tools/bench/penetration_case.h"
#include "tools/bench/report.h"
#include "tools/bench/view.h"

namespace vpm::bench {

struct SweepCase {
  std::string group, shape, scene;
  Rotation rotation;
};

// Returns the six cases of the paper: three tools moved along z into a wall and into an inverted
// sphere.
std::vector<SweepCase> paper_cases();
// Returns turned tools in four other scenes.
std::vector<SweepCase> turned_cases();
// Returns five tools, aligned and turned, in six scenes: from first contact to 60 % inside.
std::vector<SweepCase> all_cases();

// Settings that each case is run with: every combination, with and without noise, by both measures.
struct SweepSettings {
  std::vector<std::uint32_t> spheres;
  std::vector<CloudKind> kinds;
  int poses = 0;
};

// Runs cases and collects their errors: an entry of `results` for each combination, and a row of
// `table` for each pose of the paper's and the turned cases.
class Sweeps {
 public:
  using ToolOf = std::function<const PackedSolid&(const std::string& shape)>;
  Sweeps(ToolOf tool, std::uint64_t noise_seed, Shadows shadows, const Device& device,
         Report& report);

  void run(const SweepCase& c, const SweepSettings& settings);

  // Holds group, cloud, noise, measure, spheres.
  using Key = std::array<std::string, 5>;
  const std::map<Key, GroupErrors>& groups() const { return groups_; }

 private:
  struct Path {
    std::vector<Pose> poses;
    std::vector<synthetic::Penetration> truth;
  };
  const View& view(const synthetic::Scene& scene, CloudKind kind, Noise noise);
  std::vector<Unseen> unseen_along(const PackedSolid& tool, const std::vector<Pose>& poses,
                                   const synthetic::Scene& scene, CloudKind kind);
  void measure(const SweepCase& c, const Path& path, const std::vector<Unseen>& unseen,
               CloudKind kind, Noise noise, Measure measure, std::uint32_t spheres);
  void add_rows(const SweepCase& c, Noise noise, const std::string& measure, const Path& path,
                const std::vector<Result>& measured);

  ToolOf tool_;
  std::uint64_t noise_seed_;
  Shadows shadows_;  // for the refined measure
  Device device_;
  Report& report_;
  std::map<std::array<std::string, 3>, View> views_;
  std::map<Key, GroupErrors> groups_;
};

}  // namespace vpm::bench
