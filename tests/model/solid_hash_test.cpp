#include <gtest/gtest.h>

#include <cmath>

#include "libvpm/model/solid.h"
#include "tests/formats/golden_content.h"

namespace vpm {
namespace {

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
