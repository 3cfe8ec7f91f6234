#include "tools/query/contact_lines.h"

namespace vpm::tools {
namespace {

// Returns the coordinates in a unit of so many metres.
nlohmann::ordered_json in_unit(Vec3 v, double unit = 1) {
  return {v.x / unit, v.y / unit, v.z / unit};
}

void add_geometry(const Contact& c, double metres, nlohmann::ordered_json& line) {
  line["volume"] = c.volume / (metres * metres * metres);
  line["centroid"] = in_unit(c.centroid, metres);
  line["normal"] = in_unit(c.normal);
  line["area"] = c.area / (metres * metres);
  line["depth"] = c.depth / metres;
}

}  // namespace

nlohmann::ordered_json contacts_of_pair(std::span<const Contact> contacts, double metres) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Contact& c : contacts) {
    nlohmann::ordered_json& line = list.emplace_back();
    add_geometry(c, metres, line);
    line["patches"] = c.patches;
  }
  return list;
}

nlohmann::ordered_json contacts_of_pose(std::span<const Contact> contacts) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Contact& c : contacts) {
    nlohmann::ordered_json& line = list.emplace_back();
    line["body"] = c.body == Contact::kSeveralBodies ? nlohmann::ordered_json()
                                                     : nlohmann::ordered_json(c.body);
    add_geometry(c, 1, line);
    line["force"] = in_unit(c.wrench.force);
    line["torque"] = in_unit(c.wrench.torque);
    line["patches"] = c.patches;
  }
  return list;
}

}  // namespace vpm::tools
