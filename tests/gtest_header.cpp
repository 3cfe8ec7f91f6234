// Gives vpm_gtest_header a source; the target exists for its precompiled header.
