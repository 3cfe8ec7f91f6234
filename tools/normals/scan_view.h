// vpm-normals --view: what a sensor saw, and which pixels have a normal.
#pragma once

#include <string>

#include "libvpm/import/import_cloud.h"

namespace vpm::tools {

// `input` is the name of the file that was imported.
void write_scan_view(const std::string& path, const std::string& input,
                     const ImportedCloud& imported, const NormalOptions& options);

}  // namespace vpm::tools
