// The page's text before and after its data: page.html, the scripts and the drawing library, put
// together when vpm is built (embed.cmake). Both are empty in a build without the drawing library.
#pragma once

#include <string_view>

namespace vpm::view {

extern const std::string_view kPageHead, kPageTail;

}  // namespace vpm::view
