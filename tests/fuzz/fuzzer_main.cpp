// Entry points of libFuzzer. VPM_FUZZ_TARGET names the target; libFuzzer's own options follow.
#include <cstdio>
#include <cstdlib>

#include "libvpm/core/parallel.h"
#include "tests/fuzz/fuzz_target.h"
#include "tests/fuzz/fuzz_worker.h"

namespace {

const vpm::fuzz::Target* target = nullptr;

}  // namespace

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);
extern "C" int LLVMFuzzerInitialize(int*, char***);
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed);

// Options of AddressSanitizer, which the variable ASAN_OPTIONS changes. symbolize=1 names the
// functions of a finding; it takes seconds, and some files of scenes end a worker.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0:malloc_context_size=1:quarantine_size_mb=16:max_allocation_size_mb=320:"
         "symbolize=0";
}

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* const name = std::getenv("VPM_FUZZ_TARGET");
  target = name != nullptr ? vpm::fuzz::find_target(name) : nullptr;
  if (target == nullptr) {
    std::fputs("set VPM_FUZZ_TARGET to one of these:", stderr);
    for (const vpm::fuzz::Target& each : vpm::fuzz::all_targets())
      std::fprintf(stderr, " %s", each.name);
    std::fputs("\n", stderr);
    std::exit(2);
  }
  vpm::set_thread_count(1);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const vpm::fuzz::Bytes input = std::as_bytes(std::span(data, size));
  if (target->may_crash) {
    static vpm::fuzz::Worker worker(*target);
    worker.run(input);
  } else {
    vpm::fuzz::run_in_time(*target, input);
  }
  return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  return target->mutate != nullptr ? target->mutate(data, size, most, seed)
                                   : LLVMFuzzerMutate(data, size, most);
}
