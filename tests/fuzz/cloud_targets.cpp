#include "libvpm/import/import_cloud.h"
#include "tests/fuzz/query_check.h"
#include "tests/fuzz/targets.h"

namespace vpm::fuzz {
namespace {

constexpr std::size_t kMostBytes = 64 * 1024;  // of clouds that are queried

void run_cloud(Bytes input, const std::string& name, bool has_intrinsics) {
  if (input.size() > kMostBytes) return;
  expect_error_at_most([&] {
    ImportOptions options;
    if (has_intrinsics) options.intrinsics = {20, 20, 7.5, 5.5};
    const ImportedCloud imported = import_cloud(input, name, options);
    validate(imported.cloud, "imported");
    expect_sound_answers(imported.cloud);
  });
}

}  // namespace

// The length decides whether there are intrinsics, so that seeds are plain files.
void run_pcd(Bytes input) {
  run_cloud(input, "x.pcd", input.size() % 2 == 1);
}
void run_ply_points(Bytes input) {
  run_cloud(input, "x.ply", false);
}

}  // namespace vpm::fuzz
