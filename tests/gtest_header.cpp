// What vpm_gtest_header is made of: nothing but its precompiled header.
