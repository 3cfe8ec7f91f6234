// Marks what the shared libraries export; everything else in them is hidden.
#pragma once

#if defined(__GNUC__)
#define VPM_API __attribute__((visibility("default")))
#else
#define VPM_API
#endif
