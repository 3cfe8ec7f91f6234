// vpm-pack --urdf: spheres for all links of a robot.
#include <vpm/robot.h>
#include <vpm/version.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <system_error>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/file/overwrite.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"
#include "libvpm/model/packing.h"
#include "libvpm/packing/certificate.h"
#include "libvpm/packing/grow.h"
#include "libvpm/packing/packer.h"
#include "libvpm/packing/packing_export.h"
#include "tools/common/error_text.h"
#include "tools/common/remarks.h"
#include "tools/pack/outer_fit.h"
#include "tools/pack/pack_report.h"

namespace vpm::tools {
namespace {

namespace fs = std::filesystem;

// A link that has collision geometry.
struct PackedLink {
  std::size_t link;  // its number in the robot
  SolidMesh mesh;
  std::size_t count = 0;  // of spheres that it is to have
  std::vector<Sphere> spheres = {};
  nlohmann::json facts = {};  // how the spheres were proven

  const CheckedSolid& solid() const { return HandleAccess::held(mesh); }
};

// Gives each link as many spheres as are asked for, or shares those of --robot-spheres: one for
// each link, and the others by volume, those that the division leaves to the largest remainders.
void share_spheres(const Arguments& a, std::vector<PackedLink>& links) {
  for (PackedLink& link : links) link.count = a.robot_spheres ? 1 : a.spheres;
  if (!a.robot_spheres) return;
  if (*a.robot_spheres < links.size())
    refuse_usage("--robot-spheres " + std::to_string(*a.robot_spheres) +
                 " are too few: there are " + std::to_string(links.size()) +
                 " links with geometry; give one for each at least");
  const auto rest = static_cast<double>(*a.robot_spheres - links.size());
  double volume = 0;
  for (const PackedLink& link : links) volume += link.solid().facts.volume;
  std::vector<double> remainder;
  std::size_t given = links.size();
  for (PackedLink& link : links) {
    const double part = rest * (link.solid().facts.volume / volume), whole = std::floor(part);
    link.count += static_cast<std::size_t>(whole);
    given += static_cast<std::size_t>(whole);
    remainder.push_back(part - whole);
  }
  std::vector<std::size_t> order(links.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](std::size_t k) { return remainder[k]; });
  for (std::size_t k = 0; given < *a.robot_spheres; ++k, ++given) ++links[order[k]].count;
}

std::vector<PackedLink> read_links(const Program& program, const Arguments& a, const Robot& robot) {
  // Spheres that lie in what lies in a cylinder lie in the cylinder; those that hold what is about
  // it hold the cylinder.
  const RoundShape round = a.outer ? RoundShape::outside : RoundShape::inside;
  std::vector<PackedLink> links;
  for (std::size_t k = 0; k < robot.links.size(); ++k) {
    const RobotLink& link = robot.links[k];
    if (link.shapes.empty()) continue;
    links.push_back({k, link_solid(robot, k, round, solid_options(a))});
    const std::string about = "link '" + file::shown(link.name) + "': ";
    for (const std::string& note : links.back().solid().notes) program.note(about + note);
    // Shapes of one link overlap as a rule, which is no reason for a warning.
    for (const std::string& warning : links.back().solid().warnings)
      link.shapes.size() > 1 ? program.detail(about + warning) : program.warn(about + warning);
  }
  return links;
}

void pack_link(const Program& program, const Arguments& a, const std::string& name,
               PackedLink& link) {
  const CheckedSolid& checked = link.solid();
  if (a.outer) {
    OuterFit fit = outer_fit("link '" + name + "'", checked, link.count, program);
    link.spheres = std::move(fit.spheres);
    link.facts = {{"certified", fit.certificate.holds}, {"cells", fit.certificate.cells}};
    return;
  }
  Progress progress("packing link " + name, program.common());
  PackOptions options;
  options.spheres = link.count;
  options.enclosure = &checked.enclosure;
  options.progress = [&](double done) { progress.update(done); };
  const PackResult packed = pack(checked.solid, options);
  link.spheres = packed.spheres;
  if (link.spheres.size() != link.count)
    refuse("only " + std::to_string(link.spheres.size()) + " of the " + std::to_string(link.count) +
               " spheres asked for fit into link '" + file::shown(name) + "'",
           a.urdf,
           "give --spheres " + std::to_string(std::max<std::size_t>(1, link.spheres.size())));
  if (a.grow) link.spheres = grow(checked.solid, link.spheres, {.enclosure = &checked.enclosure});
  const Certificate certificate = certify(checked.solid, link.spheres, &checked.enclosure);
  refuse_uncertified("link '" + name + "'", packed.coverage, certificate);
  link.facts = {{"certified", certificate.holds},
                {"max_overlap", std::max(0.0, certificate.max_overlap)}};
}

// Writes FOLDER/LINK.vpmp for each link.
void write_packings(const Program& program, const Arguments& a, const Robot& robot,
                    const std::vector<PackedLink>& links) {
  std::error_code fault;
  fs::create_directories(a.output, fault);
  for (const PackedLink& link : links) {
    const std::string& name = robot.links[link.link].name;
    Packing packing{link.spheres, link.solid().solid, {}};
    packing.provenance.json() = {{"tool", program.name()},
                                 {"version", VPM_VERSION},
                                 {"parameters", {{"spheres", link.count}, {"grow", a.grow}}},
                                 {"link", name},
                                 {"solid_hash", content_hash(packing.solid)}};
    write_packing((fs::path(a.output) / (name + ".vpmp")).string(), packing);
  }
}

// Throws Error(invalid_argument) if packings cannot be written, before the work begins.
void check_folder(const Arguments& a, const CommonOptions& common, const Robot& robot) {
  if (a.outer) refuse_usage("a packing's spheres do not overlap: leave --output out with --outer");
  for (const RobotLink& link : robot.links) {
    if (link.name.find('/') != link.name.npos && !link.shapes.empty())
      refuse("link '" + file::shown(link.name) + "' cannot name a file", a.urdf,
             "write an --export, or call it by a name without /");
    const std::string path = (fs::path(a.output) / (link.name + ".vpmp")).string();
    std::error_code fault;
    if (!common.force && fs::exists(path, fault)) file::check_output(path, file::Kind::packing);
  }
}

std::string text_of_export(const std::string& path, const Arguments& a, const Robot& robot,
                           const RobotSpheres& spheres, std::span<const std::vector<Sphere>> all) {
  switch (export_format(path)) {
    case ExportFormat::yml:
      return packing_as_yml(spheres);
    case ExportFormat::xrdf:
      return packing_as_xrdf(spheres);
    case ExportFormat::srdf:
      return packing_as_srdf(spheres);
    case ExportFormat::urdf:
      return urdf_with_spheres(a.urdf, robot, all);
    default:
      return robot_as_csv(spheres);
  }
}

void check_exports(const Arguments& a) {
  for (const std::string& path : a.exports)
    if (!names_links(export_format(path)) && !file::in_lower_case(path).ends_with(".csv"))
      refuse_usage("--export " + path +
                   " knows no links: give a .yml, .xrdf, .urdf, .srdf or .csv");
}

nlohmann::json report_of(const Arguments& a, const Robot& robot,
                         const std::vector<PackedLink>& links) {
  nlohmann::json report = {{"robot", robot.name},
                           {"outer", a.outer},
                           {"inflate", a.inflate},
                           {"spheres", 0},
                           {"links", nlohmann::json::array()}};
  std::size_t spheres = 0;
  for (const PackedLink& link : links) {
    nlohmann::json one = link.facts;
    one["link"] = robot.links[link.link].name;
    one["spheres"] = link.spheres.size();
    one["volume_mesh"] = link.solid().facts.volume;
    one["quality"] = quality_of(link.solid(), inflated(a, link.spheres));
    spheres += link.spheres.size();
    report["links"].push_back(std::move(one));
  }
  report["spheres"] = spheres;
  return report;
}

}  // namespace

void run_robot(const Program& program, const Arguments& a) {
  check_exports(a);
  const Robot robot = read_robot(a.urdf, {.package_path = a.packages});
  say(program, a.urdf, robot.remarks);
  if (!a.output.empty()) check_folder(a, program.common(), robot);
  std::vector<PackedLink> links = read_links(program, a, robot);
  share_spheres(a, links);
  RobotSpheres spheres{robot.name, {}};
  std::vector<std::vector<Sphere>> all(robot.links.size());
  std::size_t count = 0;
  for (PackedLink& link : links) {
    const std::string& name = robot.links[link.link].name;
    pack_link(program, a, name, link);
    all[link.link] = inflated(a, link.spheres);
    spheres.links.push_back({name, all[link.link]});
    count += link.spheres.size();
  }
  if (!a.report.empty()) file::write_all(a.report, report_of(a, robot, links).dump(2) + "\n");
  for (const std::string& path : a.exports)
    file::write_all(path, text_of_export(path, a, robot, spheres, all));
  if (!a.output.empty()) write_packings(program, a, robot, links);
  program.note(std::to_string(count) + " spheres " + (a.outer ? "hold " : "lie in ") +
               std::to_string(links.size()) + " links of '" + file::shown(robot.name) + "'");
}

}  // namespace vpm::tools
