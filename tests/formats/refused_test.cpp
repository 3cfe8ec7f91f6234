// Damaged files are refused with a message, wherever the damage is.
#include <gtest/gtest.h>

#include "libvpm/cloud/cloud.h"
#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/model/packing.h"
#include "libvpm/model/tool_model.h"
#include "tests/formats/refused_files.h"
#include "tests/refusal.h"
#include "tests/test_name.h"

namespace vpm {
namespace {

const std::string kFormats = VPM_SOURCE_DIR "/formats/";

void parse_as(const std::string& kind, std::vector<std::byte> bytes) {
  if (kind == "packing") parse_packing(std::move(bytes), "the file");
  if (kind == "tool model") parse_tool_model(std::move(bytes), "the file");
  if (kind == "cloud") parse_cloud(std::move(bytes), "the file");
}

// Returns the message of the refusal, or "" if the bytes are accepted.
std::string refusal_of(const std::string& kind, const std::vector<std::byte>& bytes) {
  const auto fault = test::fault_of([&] { parse_as(kind, bytes); });
  if (!fault) return "";
  EXPECT_EQ(fault->kind(), ErrorKind::refused);
  EXPECT_EQ(std::string(fault->what()).rfind("the file: ", 0), 0U) << fault->what();
  return fault->what();
}

TEST(RefusedFiles, SayWhatIsWrong) {
  const std::vector<std::byte> text = file::read_all(kFormats + "refused/manifest.json");
  const auto* begin = reinterpret_cast<const char*>(text.data());
  const nlohmann::json manifest = nlohmann::json::parse(begin, begin + text.size());
  ASSERT_GT(manifest.size(), 40U);
  for (const nlohmann::json& entry : manifest) {
    const std::string name = entry["file"], message = entry["message"];
    const std::string said =
        refusal_of(entry["read_as"], file::read_all(kFormats + "refused/" + name));
    EXPECT_NE(said.find(message), std::string::npos) << name << " said '" << said << "'";
  }
}

struct GoldenFile {
  std::string name, kind;
  friend void PrintTo(const GoldenFile& file, std::ostream* out) { *out << file.name; }
};

class DamagedFile : public testing::TestWithParam<GoldenFile> {
 protected:
  const std::string kind_ = GetParam().kind;
  const std::vector<std::byte> good_ = file::read_all(kFormats + "golden/v1/" + GetParam().name);
};

TEST_P(DamagedFile, TruncationIsRefused) {
  for (std::size_t tenth = 0; tenth < 10; ++tenth) {
    const std::size_t size = good_.size() * tenth / 10;
    EXPECT_NE(refusal_of(kind_, {good_.begin(), good_.begin() + std::ptrdiff_t(size)}), "")
        << "cut to " << size << " of " << good_.size() << " bytes";
  }
  EXPECT_NE(refusal_of(kind_, {good_.begin(), good_.end() - 1}), "");
}

TEST_P(DamagedFile, EveryChangedByteIsRefused) {
  std::vector<std::byte> bytes = good_;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned change : {0x01U, 0x80U, 0xffU}) {
      bytes[at] ^= static_cast<std::byte>(change);
      EXPECT_NE(refusal_of(kind_, bytes), "") << "byte " << at << " ^ " << change;
      bytes[at] = good_[at];
    }
  }
}

// Changes each byte under right checksums, so that the content itself is checked. Accepts both
// answers; the sanitizers catch crashes.
TEST_P(DamagedFile, EveryChangedByteUnderRightChecksumsIsReadOrRefused) {
  std::vector<std::byte> bytes = good_;
  std::size_t refused = 0;
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const unsigned change : {0x01U, 0x80U, 0xffU}) {
      bytes[at] ^= static_cast<std::byte>(change);
      if (!refusal_of(kind_, golden::resealed(bytes)).empty()) ++refused;
      bytes[at] = good_[at];
    }
  }
  EXPECT_GT(refused, bytes.size() / 4);
}

INSTANTIATE_TEST_SUITE_P(Golden, DamagedFile,
                         testing::Values(GoldenFile{"cube.vpmp", "packing"},
                                         GoldenFile{"cube.vpmg", "tool model"},
                                         GoldenFile{"surface.vpmg", "tool model"},
                                         GoldenFile{"faces.vpmg", "tool model"},
                                         GoldenFile{"wall.vpmc", "cloud"},
                                         GoldenFile{"scattered.vpmc", "cloud"}),
                         [](const auto& instance) { return test::test_name(instance.param.name); });

}  // namespace
}  // namespace vpm
