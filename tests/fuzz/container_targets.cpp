#include "libvpm/cloud/cloud.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"
#include "tests/fuzz/container_mutator.h"
#include "tests/fuzz/query_check.h"
#include "tests/fuzz/targets.h"
#ifdef VPM_FUZZ_SOLID
#include "libvpm/graph/build_tool_model.h"
#endif

namespace vpm::fuzz {

#ifdef VPM_FUZZ_SOLID
void run_vpmp(Bytes input) {
  // Sizes of the largest packing that becomes a tool model. Even one sphere takes half a second,
  // ten times that with sanitizers, so that one packing in kBuiltOf is built, chosen by its bytes.
  constexpr std::size_t kMostSpheres = 8, kMostTriangles = 24, kBuiltOf = 256;
  expect_error_at_most([&] {
    const Packing packing = parse_packing(with_mended_checksums(input), "x.vpmp");
    if (packing.spheres.size() > kMostSpheres || packing.solid.triangles.size() > kMostTriangles)
      return;
    if (Choice(input).one_of(kBuiltOf) != 0) return;
    validate(build_tool_model(packing, {}), "built");
  });
}
#endif

void run_vpmg(Bytes input) {
  expect_error_at_most([&] {
    expect_sound_answers(parse_tool_model(with_mended_checksums(input), "x.vpmg"), Choice(input));
  });
}

void run_vpmc(Bytes input) {
  expect_error_at_most([&] {
    expect_sound_answers(parse_cloud(with_mended_checksums(input), "x.vpmc"), Choice(input));
  });
}

void run_container(Bytes input) {
  const std::vector<std::byte> bytes(input.begin(), input.end());
  expect_error_at_most([&] {
    switch (Choice(input).one_of(3)) {
      case 0:
        parse_packing(bytes, "x");
        return;
      case 1:
        parse_tool_model(bytes, "x");
        return;
      default:
        parse_cloud(bytes, "x");
    }
  });
}

}  // namespace vpm::fuzz
