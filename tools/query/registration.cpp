#include "tools/query/registration.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "libvpm/api/handle_access.h"
#include "libvpm/core/error.h"
#include "libvpm/core/pose.h"
#include "libvpm/recording/frame_feed.h"
#include "tools/common/error_text.h"
#include "tools/query/solid_scene.h"

namespace vpm::tools {
namespace {

// Returns a number as text of as many decimals, of which 0 has no sign.
std::string decimals(double number, int count) {
  const double scale = std::pow(10, count);
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", count, std::round(scale * number) / scale + 0.0);
  return text;
}

// Returns the pose as --camera-pose takes it.
std::string text_of(const Pose& pose) {
  const Vec3& t = pose.translation;
  const Quaternion q = quaternion_from_rotation(pose.rotation);
  std::string text;
  for (const double number : {t.x, t.y, t.z}) text += decimals(number, 6) + ",";
  for (const double number : {q.x, q.y, q.z}) text += decimals(number, 7) + ",";
  return text + decimals(q.w, 7);
}

// Returns what register_cameras() does. Errors that name an image by its number name it as given.
Registration registered_by_name(const std::vector<std::string>& names,
                                const std::vector<Body>& images) {
  try {
    return register_cameras(images);
  } catch (const Error& fault) {
    std::string where;
    for (std::size_t k = 0; k < names.size(); ++k)
      if (fault.where() == "image " + std::to_string(k + 1) + " of the list") where = names[k];
    throw Error(fault.kind(), "--register: " + fault.problem(), where, fault.hint());
  }
}

}  // namespace

Registration registered(const Program& program, const std::vector<std::string>& names,
                        const std::vector<Pose>& told, const std::vector<Body>& images) {
  if (const auto doubted = doubted_camera(images); doubted && doubted->remark.is_warning) {
    program.note("--register: no camera is moved, since one is far from where its pose tells");
    return {told};
  }
  const Registration found = registered_by_name(names, images);
  constexpr double kMillimetre = 1e3, kDegree = 180 / 3.14159265358979323846;
  char text[300];
  std::snprintf(text, sizeof text,
                "--register: the images disagree by %.2f mm, and disagreed by %.2f mm; they tell "
                "%zu of %zu motions of cameras against each other%s",
                kMillimetre * found.after, kMillimetre * found.before, found.observable,
                found.motions, found.observable < found.motions ? "; the others stay" : "");
  program.note(text);
  for (std::size_t k = 0; k < names.size(); ++k) {
    const Pose& now = found.to_world[k];
    const Vec3 turn = rotation_vector(now.rotation * transpose(told[k].rotation));
    std::snprintf(text, sizeof text, ": its camera is moved by %.2f mm and %.3f degrees, to ",
                  kMillimetre * norm(now.translation - told[k].translation), kDegree * norm(turn));
    program.note(names[k] + text + text_of(now));
  }
  return found;
}

namespace {

// Returns the first frame of a recording that is a depth image and can be used.
PreparedChange first_image(const std::string& name, std::size_t source, const ImportOptions& import,
                           const Recording& recording) {
  FrameReader reader(recording, import);
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    const RecordedFrame& frame = recording.frames[k];
    if (frame.source != source) continue;
    if (is_ready_cloud(frame))
      throw Error(ErrorKind::refused, "--register does not move clouds that keep their poses",
                  frame.path, "give the depth images, or --cloud for each camera");
    if (PreparedChange image = reader.prepare({0, {k}}); image.camera) return image;
  }
  throw Error(ErrorKind::refused, "--register: no depth image can be used", name);
}

}  // namespace

void move_to_agree(const Program& program, const std::vector<std::string>& names,
                   const ImportOptions& import, Recording& recording) {
  std::vector<Pose> told;
  std::vector<Body> images;
  for (std::size_t source = 0; source < names.size(); ++source) {
    const PreparedChange image = first_image(names[source], source, import, recording);
    told.push_back(image.camera->to_world);
    images.push_back(HandleAccess::make<Body>(*image.body));
  }
  const std::vector<Pose> now = registered(program, names, told, images).to_world;
  for (RecordedFrame& frame : recording.frames) {
    const Pose& first = told[frame.source];
    const Pose moved = relative_to(first, now[frame.source]);  // in the camera's frame
    const bool stands = !frame.camera || (frame.camera->translation == first.translation &&
                                          frame.camera->rotation.row0 == first.rotation.row0 &&
                                          frame.camera->rotation.row1 == first.rotation.row1);
    frame.camera = stands ? now[frame.source]
                          : Pose{exact_rotation(frame.camera->rotation * moved.rotation),
                                 *frame.camera * moved.translation};
  }
}

}  // namespace vpm::tools
