// vpm-replay [FILE]: prints the hash of the replay's bytes and writes these to FILE.
#include <cstdio>
#include <exception>

#include "libvpm/file/checksum.h"
#include "libvpm/file/stream.h"
#include "tests/query/replay.h"

int main(int argc, char** argv) {
  try {
    const std::vector<std::byte> bytes = vpm::testing::replay();
    std::printf("%s\n", vpm::file::content_hash({bytes}).c_str());
    if (argc > 1) vpm::file::write_all(argv[1], bytes);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "vpm-replay: %s\n", fault.what());
    return 1;
  }
}
