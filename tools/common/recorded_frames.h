// Recordings of depth cameras, and what the programs that read them say about their files.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "libvpm/import/import_cloud.h"
#include "libvpm/recording/recording.h"
#include "tools/common/program.h"

namespace vpm::tools {

// Reads a recording. Puts the intrinsics that lie beside its frames into `import` where it has
// none, which is noted. Throws what read_recording throws, and Error(invalid_argument) for options
// of a camera where the frames are clouds that hold theirs.
Recording open_recording(const Program& program, const std::string& path,
                         const RecordingOptions& options, ImportOptions& import);

// Says where the camera's poses come from, and what of them and of the frames' times is odd.
void note_recording(const Program& program, const std::string& path, const Recording& recording,
                    const ImportOptions& import);

// Notes that rotations have been normalised, if the deviation is beyond rounding. `what` names the
// file; "" leaves it out.
void note_deviation(const Program& program, const std::string& what, double deviation);

// Notes how many lines of a file of poses were skipped since they are undefined, and how many were
// dropped since they give the line before again.
void note_lines(const Program& program, const std::string& name, std::size_t undefined,
                std::size_t doubled);

// Warns of a time without poses, across which they are interpolated.
void warn_of_gap(const Program& program, const std::string& name,
                 const std::optional<PoseGap>& gap);

}  // namespace vpm::tools
