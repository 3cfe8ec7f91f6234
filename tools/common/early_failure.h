// Says why a program cannot start.
//
// liblog4cplus, which libopenvdb loads, makes threads before main() and lets the exception out if
// there can be none, which would abort every program that links OpenVDB without a word of use, also
// for --version.
#pragma once

namespace vpm::tools {

// Ends the time in which an exception that nothing catches means that the program cannot start. The
// time begins before the first constructor of any library. Call it first in main().
void end_of_early_failures();

}  // namespace vpm::tools
