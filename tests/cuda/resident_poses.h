// Asks a query about poses that lie in a device's memory.
#pragma once

#include <vpm/device_batch.h>

#include <span>
#include <vector>

#include "libvpm/query/tool_query.h"

namespace vpm::testing {

// Copies the numbers of poses, `width` each, to the first device, asks, and copies the answers
// back. Gives up poses and answers in the order that programs may: the poses when the answers are
// there.
std::vector<DeviceResult> ask_on_device(ToolQuery& query, std::span<const AnyBody> scene,
                                        const std::vector<double>& numbers, std::uint32_t width);

}  // namespace vpm::testing
