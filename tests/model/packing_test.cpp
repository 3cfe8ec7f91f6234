#include "libvpm/model/packing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "libvpm/model/solid.h"
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

TEST(ContentHash, IdentifiesTheSolid) {
  const Solid cube = golden::cube_packing().solid;
  const std::string hash = content_hash(cube);
  EXPECT_EQ(hash.size(), 32U);
  EXPECT_EQ(hash.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(content_hash(cube), hash);

  Solid moved = cube;
  moved.vertices[3].y = std::nextafter(moved.vertices[3].y, 1);
  EXPECT_NE(content_hash(moved), hash);
  Solid turned = cube;
  std::swap(turned.triangles[5][0], turned.triangles[5][1]);
  EXPECT_NE(content_hash(turned), hash);
  Solid open = cube;
  open.triangles.pop_back();
  EXPECT_NE(content_hash(open), hash);
}

}  // namespace
}  // namespace vpm
