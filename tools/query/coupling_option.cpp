#include "tools/query/coupling_option.h"

#include <array>
#include <charconv>
#include <cstdio>

#include "libvpm/core/error.h"
#include "libvpm/haptics/virtual_coupling.h"

namespace vpm::tools {
namespace {

[[noreturn]] void wrong(const std::string& text) {
  throw Error(
      ErrorKind::invalid_argument,
      "--coupling " + text + ": give stiffness=N/m,damping=N s/m and, if wanted, mass=kg,rate=Hz");
}

double number_from(std::string_view value, const std::string& text) {
  double number = 0;
  const auto [stop, fault] = std::from_chars(value.data(), value.data() + value.size(), number);
  if (fault != std::errc() || stop != value.data() + value.size()) wrong(text);
  return number;
}

// Returns the stiffest contact that the tool can make, N/m. The force grows by stiffness times the
// cross-section for each metre, and a ball of the tool's radius bounds that section.
double stiffest_contact(const ToolModel& model, double stiffness) {
  return stiffness * kPi * model.reach * model.reach;
}

// Returns a warning if the parameters are unstable in a scene of this stiffness (N/m^3), otherwise
// "".
std::string coupling_warning(const CouplingParameters& p, const ToolModel& model,
                             double stiffness) {
  const double contact = stiffest_contact(model, stiffness);
  const double limit = coupling_limits(p).contact_stiffness;
  if (contact <= limit) return "";
  char text[256];
  std::snprintf(text, sizeof text,
                "--coupling is stable against contacts up to %.3g N/m, but with --stiffness %.3g "
                "this tool can make one of %.3g N/m: take rate=%.0f or more, a larger mass, or "
                "less --stiffness",
                limit, stiffness, contact, std::ceil(stable_rate(p, contact)));
  return text;
}

// Returns a note on the damping that a real device needs to render this.
std::string coupling_note(const CouplingParameters& p) {
  char text[192];
  std::snprintf(text, sizeof text,
                "mass %.3g kg, radius of gyration %.3g m; to be passive a device that renders this "
                "needs a damping of its own of %.3g N s/m",
                p.mass, p.gyration, coupling_limits(p).device_damping);
  return text;
}

}  // namespace

CouplingParameters coupling_from_text(const std::string& text, const ToolModel& model,
                                      double rate) {
  CouplingParameters p;
  p.rate = rate;
  const std::array<std::pair<std::string_view, double*>, 4> known{
      {{"stiffness", &p.stiffness}, {"damping", &p.damping}, {"mass", &p.mass}, {"rate", &p.rate}}};
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::string_view item = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(item.size() + 1, rest.size()));
    const std::size_t equals = item.find('=');
    if (equals == std::string_view::npos) wrong(text);
    double* value = nullptr;
    for (const auto& [name, target] : known)
      if (name == item.substr(0, equals)) value = target;
    if (value == nullptr) wrong(text);
    *value = number_from(item.substr(equals + 1), text);
    if (!(*value > 0)) wrong(text);
  }
  if (!(p.stiffness > 0 && p.damping > 0)) wrong(text);
  if (p.mass == 0) p.mass = critical_mass(p.stiffness, p.damping);
  p.gyration = radius_of_gyration(model);
  validate(p);
  return p;
}

void note_coupling(const Tool& tool, const CouplingParameters& parameters, const ToolModel& model,
                   double stiffness) {
  tool.note("coupling: " + coupling_note(parameters));
  const std::string warning = coupling_warning(parameters, model, stiffness);
  if (!warning.empty()) tool.warn(warning);
}

}  // namespace vpm::tools
