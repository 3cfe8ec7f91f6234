#include <vpm/robot.h>

#include <algorithm>
#include <set>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/packing/packing_export.h"
#include "libvpm/robot/xml_file.h"

namespace vpm {
namespace {

using Pair = std::array<std::size_t, 2>;

Pair ordered(std::size_t a, std::size_t b) {
  return {std::min(a, b), std::max(a, b)};
}

// Adds, for each link but the root, its pair with the nearest link above it that has shapes.
void add_adjacent(const Robot& robot, std::set<Pair>& pairs) {
  for (const RobotJoint& joint : robot.joints) {
    std::size_t above = joint.parent;
    while (robot.links[above].shapes.empty() && above > 0) above = robot.joints[above - 1].parent;
    pairs.insert(ordered(above, joint.child));
  }
  // Links that hang on one frame are adjacent, too.
  for (const RobotJoint& a : robot.joints)
    for (const RobotJoint& b : robot.joints)
      if (a.child < b.child && a.parent == b.parent && robot.links[a.parent].shapes.empty())
        pairs.insert({a.child, b.child});
}

class Srdf {
 public:
  Srdf(const Robot& robot, const std::string& path) : robot_(robot), path_(path) {}

  void read(std::set<Pair>& pairs) const {
    const XmlFile file(path_, text_of_xml(path_), "robot", "an SRDF file");
    // A link that collides with none by default, but for the pairs that are enabled.
    for (const TiXmlElement* element : file.children("disable_default_collisions"))
      for (std::size_t k = 0; k < robot_.links.size(); ++k)
        if (const std::size_t link = link_of(*element, "link"); k != link)
          pairs.insert(ordered(link, k));
    for (const TiXmlElement* element : file.children("enable_collisions"))
      pairs.erase(ordered(link_of(*element, "link1"), link_of(*element, "link2")));
    for (const TiXmlElement* element : file.children("disable_collisions"))
      pairs.insert(ordered(link_of(*element, "link1"), link_of(*element, "link2")));
  }

 private:
  std::size_t link_of(const TiXmlElement& element, const char* name) const {
    const std::string link = attribute(element, name);
    if (const auto found = robot_.link(link)) return *found;
    refuse("line " + std::to_string(element.Row()) + ": the robot has no link '" +
               file::shown(link) + "'",
           path_, "give the SRDF of this robot");
  }

  const Robot& robot_;
  const std::string& path_;
};

void append_sphere(TiXmlElement& link, const Sphere& sphere) {
  TiXmlElement collision("collision"), origin("origin"), geometry("geometry"), ball("sphere");
  const auto& [x, y, z] = sphere.center;
  origin.SetAttribute("xyz", digits(x) + " " + digits(y) + " " + digits(z));
  origin.SetAttribute("rpy", "0 0 0");
  ball.SetAttribute("radius", digits(sphere.radius));
  geometry.InsertEndChild(ball);
  collision.InsertEndChild(origin);
  collision.InsertEndChild(geometry);
  link.InsertEndChild(collision);
}

}  // namespace

std::vector<std::array<std::size_t, 2>> ignored_pairs(const Robot& robot, const std::string& srdf) {
  std::set<Pair> pairs;
  srdf.empty() ? add_adjacent(robot, pairs) : Srdf(robot, srdf).read(pairs);
  return {pairs.begin(), pairs.end()};
}

std::string urdf_with_spheres(const std::string& path, const Robot& robot,
                              std::span<const std::vector<Sphere>> spheres) {
  XmlFile file(path, text_of_xml(path), "robot", "a URDF file");
  TiXmlElement* const root = file.document().RootElement();
  for (TiXmlElement* link = root->FirstChildElement("link"); link != nullptr;
       link = link->NextSiblingElement("link")) {
    while (TiXmlElement* const collision = link->FirstChildElement("collision"))
      link->RemoveChild(collision);
    const auto number = robot.link(attribute(*link, "name"));
    if (!number) continue;  // no joint leads to it
    for (const Sphere& sphere : spheres[*number]) append_sphere(*link, sphere);
  }
  TiXmlPrinter printer;
  printer.SetIndent("  ");
  file.document().Accept(&printer);
  return printer.Str();
}

}  // namespace vpm
