// Reads from 3MF files which parts slicers tell to be no part of the solid.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libvpm/mesh/scene_archive.h"
#include "libvpm/mesh/threemf_model.h"

namespace vpm {

enum class ThreemfRole { solid, left_out, cut_away };

// Returns what becomes of an object or volume whose type has this name in the core specification or
// in a slicer's settings. A type that is not known is solid, as slicers take it.
ThreemfRole role_of(const std::string& word);

struct SlicerSettings {
  // Volumes by the object of the main model, as PrusaSlicer and those after it tell.
  std::map<std::uint64_t, std::vector<ThreemfVolume>> volumes;
  // Roles by the object and the object of one of its components, as Bambu Studio, OrcaSlicer and
  // PrusaSlicer 3 tell.
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> parts;
  // Items of the build, by their order, that are not to be printed, as PrusaSlicer 3 tells.
  std::set<std::uint64_t> unprinted;
};

// Reads the settings in the archive, if there are any. Throws Error(refused) with the file's name
// if they are damaged: what they leave out would be taken for solid.
SlicerSettings slicer_settings(ZipArchive& archive, const std::string& name);

}  // namespace vpm
