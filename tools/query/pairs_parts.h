// Parts of an assembly, read and made ready to be measured.
#pragma once

#include <vpm/solid.h>

#include <cstddef>
#include <vector>

#include "tools/common/program.h"
#include "tools/query/pairs_assembly.h"

namespace vpm::tools {

struct PreparedParts {
  std::vector<Part> parts;          // those that are solids, at their poses, in metres
  std::vector<std::size_t> places;  // of each in the assembly
};

// Reads the parts on several threads; what several parts have in common, files of equal content, is
// read and prepared once. `metres` is the assembly's unit, in which meshes are whose format has no
// unit; poses are too. `options` say how meshes are repaired, and whether the unit was told. Prints
// an error for each part that is refused, which is then left out, and what is doubtful of the
// others. Forces are prepared if `with_force`. Throws Error(unavailable) where meshes, or those of
// a format, cannot be read at all.
PreparedParts prepare_parts(const Program& program, const Assembly& assembly, double metres,
                            const SolidOptions& options, bool with_force);

}  // namespace vpm::tools
