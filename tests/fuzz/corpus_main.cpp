// Runs a target on the files of folders, without the fuzzer: vpm-fuzz-corpus TARGET FOLDER...
//
// A file may take five seconds, and 64 times its size and 256 MB of memory beyond what the process
// has anyway. Folders that do not exist are empty. `vpm-fuzz-corpus` alone lists the targets.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "libvpm/core/parallel.h"
#include "tests/fuzz/fuzz_target.h"

// Stands for libFuzzer's.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t*, std::size_t size, std::size_t) {
  return size;
}

namespace {

namespace fs = std::filesystem;

constexpr double kMostSeconds = 5;

std::vector<char> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Returns the largest memory that the process has had, in bytes.
std::uint64_t peak_memory() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  constexpr std::uint64_t kUnit = 1024;
  return kUnit * static_cast<std::uint64_t>(used.ru_maxrss);
}

void run(const vpm::fuzz::Target& target, const fs::path& path) {
  std::fprintf(stderr, "%s\n", path.c_str());  // tells which file it was if the process ends here
  const std::vector<char> bytes = bytes_of(path);
  const std::uint64_t before = peak_memory();
  const auto start = std::chrono::steady_clock::now();
  target.run(std::as_bytes(std::span(bytes)));
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
  if (taken.count() > kMostSeconds)
    vpm::fuzz::fail("it takes " + std::to_string(taken.count()) + " s");
  const std::uint64_t most = 64 * bytes.size() + 256'000'000;
  if (peak_memory() - before > most)
    vpm::fuzz::fail("it takes " + std::to_string(peak_memory() - before) + " bytes of memory");
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2) {
    for (const vpm::fuzz::Target& target : vpm::fuzz::all_targets()) std::puts(target.name);
    return 0;
  }
  const vpm::fuzz::Target* const target = vpm::fuzz::find_target(arguments[1]);
  if (target == nullptr) {
    std::fprintf(stderr, "there is no target %s\n", arguments[1]);
    return 2;
  }
  vpm::set_thread_count(1);
  std::size_t files = 0;
  for (int k = 2; k < count; ++k) {
    if (!fs::exists(arguments[k])) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(arguments[k])) {
      if (!entry.is_regular_file()) continue;
      run(*target, entry.path());
      ++files;
    }
  }
  std::printf("%zu files\n", files);
  return files > 0 ? 0 : 1;
}
