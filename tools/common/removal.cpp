#include "tools/common/removal.h"

#include <vpm/error.h>
#include <vpm/solid.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libvpm/file/text.h"
#include "tools/common/error_text.h"
#include "tools/common/solid_argument.h"

namespace vpm::tools {
namespace {

[[noreturn]] void refuse_margin(const std::string& text, const std::string& what) {
  refuse_usage("--remove-margin " + text + ": " + what +
               "; give metres, such as 0.02, or time=S,speed=M/S,calibration=M");
}

double number_of_margin(const std::string& text, const std::string& number) {
  const std::optional<double> value = file::to_number(number);
  if (!value || !(*value >= 0 && std::isfinite(*value)))
    refuse_margin(text, "'" + number + "' is no number from 0 on");
  return *value;
}

std::string number_text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

// Returns the words of a margin, after the largest one where that differs from solid to solid.
std::string margin_text(const std::string& words, double largest) {
  const std::string most = number_text(largest) + " m";
  return words.starts_with(most) ? words : "up to " + most + ", of " + words;
}

// True if a solid lies in view where the image was measured, and hardly anything measured is there.
bool explains_nothing(const RemovedSolid& found) {
  constexpr std::size_t kFewest = 50, kShare = 50;  // pixels, and one in so many
  const std::size_t seen = found.in_view - found.hidden;
  return seen >= kFewest && found.explained < seen / kShare;
}

}  // namespace

RemovalMargin removal_margin_from_text(const std::string& text, bool have_paths) {
  RemovalMargin margin;
  if (text.find('=') == text.npos) {
    if (!text.empty()) margin.distance = number_of_margin(text, text);
    return margin;
  }
  for (std::size_t first = 0; first <= text.size();) {
    const std::size_t end = std::min(text.find(',', first), text.size());
    const std::string part = text.substr(first, end - first);
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string name = part.substr(0, equals);
    const std::string number = equals < part.size() ? part.substr(equals + 1) : "";
    if (name == "time") {
      margin.seconds = number_of_margin(text, number);
    } else if (name == "speed") {
      margin.speed = number_of_margin(text, number);
    } else if (name == "calibration") {
      margin.distance = number_of_margin(text, number);
    } else {
      refuse_margin(text, "'" + part + "' is unknown");
    }
    first = end + 1;
  }
  if (margin.seconds > 0 && !margin.speed && !have_paths)
    refuse_margin(text, "a time needs the speed of the solids");
  return margin;
}

std::string words_of(const RemovalMargin& margin) {
  const std::string rest = number_text(margin.distance) + " m";
  if (margin.seconds == 0) return rest;
  const std::string late = number_text(margin.seconds) + " s at ";
  if (!margin.speed) return late + "the speed of each solid, and " + rest + " of calibration";
  return number_text(margin.seconds * *margin.speed + margin.distance) + " m, of " + late +
         number_text(*margin.speed) + " m/s and " + rest + " of calibration";
}

Removal::Removal(const Program& program, const std::vector<std::string>& texts)
    : found_(texts.size()) {
  std::vector<SolidBody> bodies;
  for (const std::string& text : texts) {
    const auto [name, at] = solid_from_text(text, "--remove");
    bodies.push_back(solid_of_file(program, name, false));
    names_.push_back(name);
    poses_.push_back(at);
    const Vec3 center = bodies.back().center_of_mass();
    reaches_.push_back(std::hypot(center.x, center.y, center.z) + bodies.back().radius());
  }
  remover_.emplace(bodies);
}

std::size_t Removal::remove(const std::vector<SolidPlace>& places, CloudSensor& image) {
  const std::lock_guard lock(mutex_);
  const std::size_t removed = remover_->remove(places, image.camera, image.depth.depth);
  for (std::size_t k = 0; k < found_.size(); ++k) {
    const RemovedSolid& found = remover_->found()[k];
    found_[k].in_view += found.in_view;
    found_[k].hidden += found.hidden;
    found_[k].explained += found.explained;
    found_[k].holds_camera |= found.holds_camera;
  }
  for (const SolidPlace& place : places) largest_margin_ = std::max(largest_margin_, place.margin);
  ++images_;
  removed_ += removed;
  return removed;
}

void Removal::begin_counting() {
  const std::lock_guard lock(mutex_);
  images_ = removed_ = 0;
  largest_margin_ = 0;
  found_.assign(found_.size(), {});
}

void Removal::say(const Program& program, const std::string& margin) const {
  const std::lock_guard lock(mutex_);
  if (images_ == 0) return;
  program.note("--remove: " + std::to_string(removed_) + " pixels removed" +
               (images_ > 1 ? " from " + std::to_string(images_) + " images" : "") +
               ", with a margin of " + margin_text(margin, largest_margin_));
  for (std::size_t k = 0; k < found_.size(); ++k) {
    if (found_[k].holds_camera)
      program.warn("--remove: the camera is inside of " + names_[k] +
                   ", which hides all that it sees: leave that solid out");
    else if (explains_nothing(found_[k]))
      program.warn("--remove: " + names_[k] +
                   " lies in view and explains no pixel: its pose is probably wrong; it takes the "
                   "mesh to the world, in metres");
    else if (found_[k].in_view == 0)
      program.note("--remove: " + names_[k] + " is out of view");
  }
}

}  // namespace vpm::tools
