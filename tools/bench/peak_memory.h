#pragma once

namespace vpm::bench {

// Begins a new measurement of the process's peak memory. peak_memory_mb() then returns the peak
// since, MB; 0 on systems that do not report it (Linux does).
void reset_peak_memory();
double peak_memory_mb();

// Returns the memory that the process holds now, without what has been freed, MB; 0 likewise.
double resident_memory_mb();

}  // namespace vpm::bench
