#pragma once

namespace vpm::bench {

// The largest amount of memory that the process has held since reset_peak_memory(), MB; 0 where the
// system does not tell (Linux does).
void reset_peak_memory();
double peak_memory_mb();

// What it holds now, without what has been freed, MB; 0 likewise.
double resident_memory_mb();

}  // namespace vpm::bench
