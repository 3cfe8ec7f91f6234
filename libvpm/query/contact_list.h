// Lists the contacts of a scene so that they add up to its answer in bits.
#pragma once

#include <vpm/query_types.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libvpm/measure/contact_patch.h"
#include "libvpm/model/tool_model.h"

namespace vpm {

// Returns the wrench of an answer of this volume, rounded so that contacts can add up to it:
// QueryOptions::contacts tells to what.
Wrench wrench_of_contacts(const Wrench& wrench, double volume, double stiffness,
                          double tool_radius);

// Returns the `count` largest patches, and one contact with all others, as vpm/query_types.h tells.
// `whole` is the answer, its wrench rounded, of which the patches are the parts but for rounding;
// the largest takes what that leaves. Patches below 2^-60 of the tool's volume, to which answers
// are rounded, are left out. The order of patches changes no bit.
std::vector<Contact> listed_contacts(std::vector<ContactPatch> patches, std::size_t count,
                                     const Result& whole, double stiffness, const ToolModel& tool);

// Returns the nearest multiple of a step, a power of two; 0 for -0.
inline double rounded_to(double step, double value) {
  return std::nearbyint(value / step) * step + 0.0;
}
inline Vec3 rounded_to(double step, Vec3 v) {
  return {rounded_to(step, v.x), rounded_to(step, v.y), rounded_to(step, v.z)};
}

// Gives the first of several contacts or patches, the largest, what the others leave of the whole:
// so they add up to it in any order, if the others are multiples of steps in which the whole is
// counted exactly.
template <class Contacts>
void leave_rest_to_first(Contacts& contacts, double volume, const Wrench& wrench) {
  auto& first = contacts.front();
  first.volume = volume, first.wrench = wrench;
  for (std::size_t k = 1; k < contacts.size(); ++k) {
    first.volume -= contacts[k].volume;
    first.wrench.force -= contacts[k].wrench.force;
    first.wrench.torque -= contacts[k].wrench.torque;
  }
}

}  // namespace vpm
