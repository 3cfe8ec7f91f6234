#include "libvpm/query/contact_list.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "libvpm/measure/tool_piece.h"

namespace vpm {
namespace {

// Powers of two by whose multiples forces and torques are told. A contact pushes by its volume at
// most, but for its error, so sums of multiples stay below 2^53 and are exact in any order.
struct WrenchSteps {
  static constexpr int kBits = 46;
  double force, torque;

  WrenchSteps(double volume, double stiffness, double tool_radius)
      : force(step_of(stiffness * volume)), torque(step_of(stiffness * volume * tool_radius)) {}

  static double step_of(double most) {
    constexpr double kLeast = 0x1p-1000;  // whose step is a number above 0
    return std::ldexp(1.0, std::ilogb(std::max(most, kLeast)) - kBits);
  }
  Wrench rounded(const Wrench& w) const {
    return {rounded_to(force, w.force), rounded_to(torque, w.torque)};
  }
};

// Largest first; sums of several are never listed by themselves and come last.
bool comes_first(const ContactPatch& a, const ContactPatch& b) {
  const auto key = [](const ContactPatch& p) {
    return std::tuple(p.patches > 1, -p.volume, p.centroid.x, p.centroid.y, p.centroid.z, p.body);
  };
  return key(a) < key(b);
}

double floored(double value, double step) {
  return std::floor(value / step) * step;
}

// Rounds all patches but the largest, which comes first, drops those without volume, and leaves the
// rest of the whole to the largest. Volumes are rounded down: so what it gets is not less than it
// had but for rounding, and it stays the largest.
void complete(std::vector<ContactPatch>& patches, const Result& whole, const WrenchSteps& steps,
              double resolved) {
  const double bit = std::ldexp(1.0, std::ilogb(whole.volume) - 52);
  for (std::size_t k = 1; k < patches.size(); ++k) {
    patches[k].volume = floored(floored(patches[k].volume, resolved), bit);
    patches[k].wrench = steps.rounded(patches[k].wrench);
  }
  const auto others = patches.begin() + 1;
  patches.erase(std::remove_if(others, patches.end(), [](const auto& p) { return p.volume <= 0; }),
                patches.end());
  leave_rest_to_first(patches, whole.volume, whole.wrench);
  std::sort(patches.begin() + 1, patches.end(), comes_first);
}

void add(ContactPatch& sum, const ContactPatch& patch) {
  const double volume = sum.volume + patch.volume;
  sum.centroid = (sum.volume * sum.centroid + patch.volume * patch.centroid) / volume;
  sum.volume = volume;
  sum.area += patch.area;
  sum.depth = std::max(sum.depth, patch.depth);
  sum.wrench.force += patch.wrench.force, sum.wrench.torque += patch.wrench.torque;
  sum.patches += patch.patches;
  if (sum.body != patch.body) sum.body = Contact::kSeveralBodies;
}

}  // namespace

Wrench wrench_of_contacts(const Wrench& wrench, double volume, double stiffness,
                          double tool_radius) {
  if (volume == 0) return wrench;
  return WrenchSteps(volume, stiffness, tool_radius).rounded(wrench);
}

std::vector<Contact> listed_contacts(std::vector<ContactPatch> patches, std::size_t count,
                                     const Result& whole, double stiffness, const ToolModel& tool) {
  if (patches.empty() || whole.volume == 0) return {};
  std::sort(patches.begin(), patches.end(), comes_first);
  complete(patches, whole, WrenchSteps(whole.volume, stiffness, tool.radius),
           tool.volume / ToolSum::Sum::kOne);
  const auto own =
      std::min<std::size_t>(count, std::find_if(patches.begin(), patches.end(), [](const auto& p) {
                                     return p.patches > 1;
                                   }) - patches.begin());
  if (own + 1 < patches.size()) {
    for (std::size_t k = own + 1; k < patches.size(); ++k) add(patches[own], patches[k]);
    patches.resize(own + 1);
  }
  std::vector<Contact> contacts;
  for (const ContactPatch& p : patches)
    contacts.push_back({p.body, p.volume, p.centroid, normalized_or_zero(p.area), norm(p.area),
                        p.depth, p.wrench, p.patches});
  return contacts;
}

}  // namespace vpm
