// Solids that options take out of depth images: the robot, and what it holds.
#pragma once

#include <vpm/scene.h>

#include <cstddef>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "libvpm/cloud/cloud.h"
#include "tools/common/program.h"

namespace vpm::tools {

// How far a solid may have been from where its pose puts it when an image was taken.
struct RemovalMargin {
  double seconds = 0;           // by which the image may be late
  std::optional<double> speed;  // m/s, of the solid's fastest point; unset: that of its path
  double distance = 0;          // m, beside that
};

// Parses "0.02", m, or "time=0.03,speed=1.5,calibration=0.005", in any order; without a speed where
// the solids have `paths`, which tell it. Throws Error(invalid_argument).
RemovalMargin removal_margin_from_text(const std::string& text, bool have_paths);
// Returns for example "0.05 m, of 0.03 s at 1.5 m/s and 0.005 m of calibration".
std::string words_of(const RemovalMargin& margin);

// Thread-safe, but for say().
class Removal {
 public:
  // Reads the solids, each FILE or FILE@POSE. Throws what solid_from_text() and solid_of_file()
  // throw.
  Removal(const Program& program, const std::vector<std::string>& texts);

  std::size_t solids() const { return names_.size(); }
  const std::string& name(std::size_t k) const { return names_[k]; }
  // Returns the largest distance of a point of a solid from the origin of its mesh, m.
  double reach(std::size_t k) const { return reaches_[k]; }
  // Returns the poses that the texts give.
  const std::vector<Pose>& poses() const { return poses_; }

  // Marks the pixels of the image, and returns the number of those that had been measured.
  std::size_t remove(const std::vector<SolidPlace>& places, CloudSensor& image);

  // Forgets the images so far.
  void begin_counting();

  // Prints how many pixels were removed with which margin, and warns of solids whose poses are
  // probably wrong.
  void say(const Program& program, const std::string& margin) const;

 private:
  std::vector<std::string> names_;
  std::vector<Pose> poses_;
  std::vector<double> reaches_;
  std::optional<SolidRemover> remover_;
  mutable std::mutex mutex_;  // of what follows, and of the remover
  std::size_t images_ = 0, removed_ = 0;
  double largest_margin_ = 0;        // m
  std::vector<RemovedSolid> found_;  // in all images
};

}  // namespace vpm::tools
