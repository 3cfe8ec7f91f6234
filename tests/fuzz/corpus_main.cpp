// Runs a target on the files of folders, without the fuzzer: vpm-fuzz-corpus TARGET FOLDER...
//
// A file may take five seconds, and 64 times its size and 256 MB of memory beyond what the process
// has anyway; builds with a sanitizer do not measure memory. Folders that do not exist are empty.
// Then changes the files blindly for VPM_FUZZ_SECONDS (0) seconds; VPM_FUZZ_SEED (1), a number,
// says how. An input that breaks a promise lies in vpm-fuzz-last-TARGET of the temporary folder.
// `vpm-fuzz-corpus` alone lists the targets.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string_view>
#include <vector>

#include "libvpm/core/parallel.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

namespace fs = std::filesystem;
using Data = std::vector<std::uint8_t>;

// Changes bytes at random places.
class BlindChanges {
 public:
  void seed(unsigned number) { random_.seed(number); }

  // Returns a number below `end`, which is at least 1.
  std::size_t below(std::size_t end) { return random_() % end; }

  void change(Data& data) {
    const std::size_t at = below(data.size() + 1);
    const std::size_t length = std::min(data.size() - at, std::size_t{1} << below(10));
    const auto begin = data.begin() + static_cast<std::ptrdiff_t>(at),
               end = begin + static_cast<std::ptrdiff_t>(length);
    switch (below(5)) {
      case 0:
        if (length > 0) *begin ^= static_cast<std::uint8_t>(1U << below(8));
        break;
      case 1:
        std::generate(begin, begin + static_cast<std::ptrdiff_t>(std::min<std::size_t>(length, 4)),
                      [&] { return static_cast<std::uint8_t>(random_()); });
        break;
      case 2:
        data.erase(begin, end);
        break;
      case 3: {
        const Data run(begin, end);
        data.insert(data.begin() + static_cast<std::ptrdiff_t>(below(data.size() + 1)), run.begin(),
                    run.end());
        break;
      }
      default: {
        static constexpr std::string_view kWords[] = {
            "0",     "-1", "1e39", "nan", "-",  "4294967295", "18446744073709551615",
            "1e-45", " ",  "\n",   "\r",  "\"", "{",          "/"};
        const std::string_view word = kWords[below(std::size(kWords))];
        data.insert(begin, word.begin(), word.end());
      }
    }
  }

 private:
  std::mt19937 random_{1};
};

BlindChanges& blind_changes() {
  static BlindChanges changes;
  return changes;
}

}  // namespace

// Stands for libFuzzer's.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most) {
  Data changed(data, data + size);
  blind_changes().change(changed);
  if (changed.size() > most) changed.resize(most);
  std::copy(changed.begin(), changed.end(), data);
  return changed.size();
}

namespace {

Data bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kMeasuresMemory = false;  // a sanitizer keeps freed memory, and more beside it
#else
constexpr bool kMeasuresMemory = true;
#endif

// Returns the largest memory that the process has had, in bytes.
std::uint64_t peak_memory() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  constexpr std::uint64_t kUnit = 1024;
  return kUnit * static_cast<std::uint64_t>(used.ru_maxrss);
}

void run(const vpm::fuzz::Target& target, const Data& bytes) {
  const std::uint64_t before = peak_memory();
  vpm::fuzz::run_in_time(target, std::as_bytes(std::span(bytes)));
  const std::uint64_t most = 64 * bytes.size() + 256'000'000;
  if (kMeasuresMemory && peak_memory() - before > most)
    vpm::fuzz::fail("it takes " + std::to_string(peak_memory() - before) + " bytes of memory");
}

Data changed(const vpm::fuzz::Target& target, const std::vector<Data>& inputs) {
  constexpr std::size_t kMost = 16'384;
  BlindChanges& changes = blind_changes();
  Data data = inputs[changes.below(inputs.size())];
  for (std::size_t rounds = 1 + changes.below(4); rounds > 0; --rounds) {
    if (target.mutate == nullptr || data.size() > kMost) {
      changes.change(data);
      continue;
    }
    const std::size_t size = data.size();
    data.resize(kMost);
    data.resize(target.mutate(data.data(), size, kMost,
                              static_cast<unsigned>(changes.below(std::size_t{1} << 31))));
  }
  return data;
}

// Returns the number of inputs that were tried.
std::size_t run_changed(const vpm::fuzz::Target& target, const std::vector<Data>& inputs,
                        double seconds) {
  const fs::path last = fs::temp_directory_path() / ("vpm-fuzz-last-" + std::string(target.name));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::size_t tried = 0;
  for (; std::chrono::steady_clock::now() < end; ++tried) {
    const Data data = changed(target, inputs);
    std::ofstream(last, std::ios::binary)
        .write(reinterpret_cast<const char*>(data.data()),
               static_cast<std::streamsize>(data.size()));
    run(target, data);
  }
  fs::remove(last);
  return tried;
}

double number_of(const char* variable, double otherwise) {
  const char* const text = std::getenv(variable);
  return text != nullptr ? std::atof(text) : otherwise;
}

std::vector<fs::path> files_of(int count, char** folders) {
  std::vector<fs::path> files;
  for (int k = 0; k < count; ++k) {
    if (!fs::exists(folders[k])) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folders[k]))
      if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
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
  std::vector<Data> inputs;
  for (const fs::path& path : files_of(count - 2, arguments + 2)) {
    std::fprintf(stderr, "%s\n", path.c_str());  // tells which file it was if the process ends here
    inputs.push_back(bytes_of(path));
    run(*target, inputs.back());
  }
  if (inputs.empty()) return 1;
  blind_changes().seed(static_cast<unsigned>(number_of("VPM_FUZZ_SEED", 1)));
  const std::size_t tried = run_changed(*target, inputs, number_of("VPM_FUZZ_SECONDS", 0));
  std::printf("%zu files, %zu changed ones\n", inputs.size(), tried);
  return 0;
}
