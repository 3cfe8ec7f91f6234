// The version of these headers, and of the library that a program runs with.
#pragma once

#include <vpm/export.h>

// The build reads the version here. Minor versions are compatible with themselves only, until 1.0.
#define VPM_VERSION_MAJOR 0
#define VPM_VERSION_MINOR 1
#define VPM_VERSION_PATCH 0
#define VPM_VERSION "0.1.0"
#define VPM_ABI 0  // in libvpm.so.0; raised where compiled programs cannot take new libraries

// True if the headers are of this version or a later one: #if VPM_VERSION_AT_LEAST(0, 2, 0)
#define VPM_VERSION_AT_LEAST(major, minor, patch) \
  (VPM_VERSION_MAJOR > (major) ||                 \
   (VPM_VERSION_MAJOR == (major) &&               \
    (VPM_VERSION_MINOR > (minor) ||               \
     (VPM_VERSION_MINOR == (minor) && VPM_VERSION_PATCH >= (patch)))))

namespace vpm {

// Returns the version of libvpm.so, "major.minor.patch": another than VPM_VERSION if the program
// was compiled with the headers of another. Thread-safe.
VPM_API const char* version() noexcept;

}  // namespace vpm
