#include "tools/query/coupled_step.h"

#include <nlohmann/json.hpp>

#include "tools/query/query_report.h"

namespace vpm::tools {
namespace {

nlohmann::json list_of(Vec3 v) {
  return {v.x, v.y, v.z};
}
nlohmann::json list_of(const Pose& pose) {
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  const Vec3 t = pose.translation;
  return {t.x, t.y, t.z, q.x, q.y, q.z, q.w};
}

}  // namespace

std::string coupled_line(const CoupledStep& s, const std::string& frame) {
  nlohmann::ordered_json line;
  line["step"] = s.step;
  line["time"] = s.time;
  if (!frame.empty()) line["frame"] = frame;
  line["device"] = list_of(s.device);
  line["tool"] = list_of(s.tool);
  line["volume"] = s.contact.volume;
  line["volume_fraction"] = s.contact.volume_fraction;
  line["force"] = list_of(s.contact.wrench.force);
  line["torque"] = list_of(s.contact.wrench.torque);
  line["rendered_force"] = list_of(s.rendered.force);
  line["rendered_torque"] = list_of(s.rendered.torque);
  line["energy"] = {{"supplied", s.energy.supplied},
                    {"stored", s.energy.stored},
                    {"dissipated", s.energy.dissipated},
                    {"absorbed", s.energy.absorbed},
                    {"lost", s.energy.lost}};
  return to_line(line);
}

}  // namespace vpm::tools
