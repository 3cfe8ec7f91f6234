#include "tools/common/scene_report.h"

#include <cmath>
#include <cstdio>

namespace vpm::tools {

nlohmann::json scene_report(const SceneScale& scale) {
  nlohmann::json report{{"spacing", scale.spacing},
                        {"noise", scale.noise},
                        {"curvature", scale.curvature},
                        {"smallest_radius", scale.smallest_radius()}};
  if (std::isfinite(scale.largest_radius())) report["largest_radius"] = scale.largest_radius();
  return report;
}

std::string words_of(const SceneScale& scale) {
  char from[120], to[80] = "any size (flat)";
  std::snprintf(from, sizeof from, "spheres from %.3g m (points %.3g m apart, noise %.3g m) to ",
                scale.smallest_radius(), scale.spacing, scale.noise);
  if (std::isfinite(scale.largest_radius())) {
    std::snprintf(to, sizeof to, "%.3g m (curvature %.3g 1/m)", scale.largest_radius(),
                  scale.curvature);
  }
  return std::string(from) + to;
}

}  // namespace vpm::tools
