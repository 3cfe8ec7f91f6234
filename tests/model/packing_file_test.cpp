#include <gtest/gtest.h>

#include <functional>

#include "libvpm/model/packing.h"
#include "tests/formats/golden_content.h"
#include "tests/refusal.h"
#include "tests/temporary_folder.h"

namespace vpm {
namespace {

using PackingFile = test::InTemporaryFolder;

// The writer refuses the same content as the reader.
TEST_F(PackingFile, NoPackingHasWhatNoSolidCanHold) {
  const auto refused = [&](const std::function<void(Packing&)>& change) {
    Packing packing = golden::cube_packing();
    change(packing);
    return test::refusal([&] { write_packing(path("x.vpmp"), packing); });
  };
  EXPECT_EQ(refused([](Packing&) {}), "");
  const auto expect = [&](const std::string& part, const std::function<void(Packing&)>& change) {
    const std::string message = refused(change);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect("vertex 3", [](Packing& p) { p.solid.vertices[3].x = 1e300; });
  expect("sphere 2", [](Packing& p) { p.spheres[2].center.y = 1e300; });
  expect("sphere 2 lies outside", [](Packing& p) { p.spheres[2].center.y = 1; });
  expect("sphere 0", [](Packing& p) { p.spheres[0].radius = 1e300; });
}

}  // namespace
}  // namespace vpm
