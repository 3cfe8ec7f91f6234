#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include <cmath>
#include <limits>

#include "libvpm/import/depth_files.h"
#include "tests/import/test_files.h"
#include "tests/refusal.h"

namespace vpm {
namespace {

class MemorySink : public Imf::OStream {
 public:
  MemorySink() : Imf::OStream("memory") {}
  void write(const char from[], int count) override {
    if (bytes.size() < at_ + static_cast<std::size_t>(count))
      bytes.resize(at_ + static_cast<std::size_t>(count));
    bytes.replace(at_, static_cast<std::size_t>(count), from, static_cast<std::size_t>(count));
    at_ += static_cast<std::size_t>(count);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = to; }
  std::string bytes;

 private:
  std::size_t at_ = 0;
};

struct ExrChannel {
  std::string name;
  std::vector<float> values;
};

std::string make_exr(int width, int height, bool as_half, const std::vector<ExrChannel>& channels) {
  Imf::Header header(width, height);
  Imf::FrameBuffer buffer;
  std::vector<std::vector<half>> halves(channels.size());
  const auto columns = static_cast<std::size_t>(width);
  for (std::size_t c = 0; c < channels.size(); ++c) {
    const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
    header.channels().insert(channels[c].name, Imf::Channel(type));
    for (const float value : channels[c].values) halves[c].emplace_back(value);
    auto* values = const_cast<float*>(channels[c].values.data());
    const std::size_t size = as_half ? sizeof(half) : sizeof(float);
    char* base =
        as_half ? reinterpret_cast<char*>(halves[c].data()) : reinterpret_cast<char*>(values);
    buffer.insert(channels[c].name, Imf::Slice(type, base, size, size * columns));
  }
  MemorySink sink;
  {
    Imf::OutputFile file(sink, header);
    file.setFrameBuffer(buffer);
    file.writePixels(height);
  }
  return sink.bytes;
}

const float kNaN = std::numeric_limits<float>::quiet_NaN();
const float kInfinity = std::numeric_limits<float>::infinity();
const std::vector<float> kValues{1.5F, 0, kNaN, -2, kInfinity, 0.25F};

RawDepth parse(const std::string& file, const std::string& channel = "") {
  return parse_exr_depth(bytes_of(file), "file", channel);
}
std::string refusal_of_exr(const std::string& file) {
  return test::refusal([&] { parse(file); });
}

// True if both hold the same numbers; NaN is one.
bool same_values(const std::vector<float>& a, const std::vector<float>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](float x, float y) { return x == y || (std::isnan(x) && std::isnan(y)); });
}

TEST(ExrDepth, ReadsEachKindOfChannel) {
  for (const bool as_half : {false, true}) {
    EXPECT_TRUE(same_values(parse(make_exr(3, 2, as_half, {{"Z", kValues}})).values, kValues));
    EXPECT_TRUE(same_values(parse(make_exr(3, 2, as_half, {{"Y", kValues}})).values, kValues));
    const RawDepth image =
        parse(make_exr(3, 2, as_half, {{"R", kValues}, {"G", kValues}, {"B", kValues}}));
    EXPECT_TRUE(same_values(image.values, kValues));
    EXPECT_EQ(image.width, 3U);
    EXPECT_EQ(image.height, 2U);
  }
}

TEST(ExrDepth, TakesDepthByNameBesideAPicture) {
  const std::vector<float> grey(6, 0.5F);
  const std::string file =
      make_exr(3, 2, false, {{"R", grey}, {"G", grey}, {"B", grey}, {"depth.Z", kValues}});
  EXPECT_TRUE(same_values(parse(file).values, kValues));
  EXPECT_EQ(parse(file, "R").values, grey);
  EXPECT_TRUE(says(test::refusal([&] { parse(file, "Q"); }), "B, G, R, depth.Z"));
  EXPECT_TRUE(says(refusal_of_exr(make_exr(3, 2, false, {{"Z", kValues}, {"depth.Z", grey}})),
                   "Z, depth.Z"));
}

TEST(ExrDepth, SaysWhichOfALayersChannelsAreDepth) {
  const std::vector<float> grey(6, 0.5F), none(6, 0);
  const auto with_layer = [&](const std::vector<float>& others) {
    return make_exr(3, 2, false,
                    {{"R", grey},
                     {"G", grey},
                     {"B", grey},
                     {"WorldDepth.R", kValues},
                     {"WorldDepth.G", others},
                     {"WorldDepth.B", others}});
  };
  const RawDepth image = parse(with_layer(kValues));
  EXPECT_TRUE(same_values(image.values, kValues));
  ASSERT_EQ(image.remarks.size(), 1U);
  EXPECT_EQ(image.remarks[0].text,
            "depth is its channels WorldDepth.R, WorldDepth.G, WorldDepth.B, which are equal");
  EXPECT_TRUE(
      says(refusal_of_exr(with_layer(none)), "name it with `channel`, such as WorldDepth.R"));
  EXPECT_TRUE(same_values(parse(with_layer(none), "WorldDepth.R").values, kValues));
  EXPECT_TRUE(
      says(parse(make_exr(3, 2, false, {{"R", grey}, {"G", grey}, {"B", grey}})).remarks.at(0).text,
           "no channel's name says depth: R, G and B"));
}

TEST(ExrDepth, PutsACropIntoItsDisplayWindow) {
  Imf::Header header(Imath::Box2i({0, 0}, {3, 2}), Imath::Box2i({1, 1}, {5, 1}));
  header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
  std::vector<float> values{1, 2, 3, 4, 5};
  Imf::FrameBuffer buffer;
  buffer.insert("Z", Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow(), sizeof(float),
                                      5 * sizeof(float)));
  MemorySink sink;
  {
    Imf::OutputFile file(sink, header);
    file.setFrameBuffer(buffer);
    file.writePixels(1);
  }
  const RawDepth image = parse(sink.bytes);
  EXPECT_EQ(image.width, 4U);
  EXPECT_EQ(image.values, (std::vector<float>{0, 0, 0, 0, 0, 1, 2, 3, 0, 0, 0, 0}));
  ASSERT_EQ(image.remarks.size(), 1U);
  EXPECT_TRUE(says(image.remarks[0].text, "4 x 3 pixels is read")) << image.remarks[0].text;
}

TEST(ExrDepth, RefusesWhatIsNoDepth) {
  std::vector<float> other = kValues;
  other[5] = 0.5F;
  EXPECT_TRUE(
      says(refusal_of_exr(make_exr(3, 2, true, {{"R", kValues}, {"G", other}, {"B", kValues}})),
           "R, G and B differ at pixel (2, 1)"));
  EXPECT_TRUE(says(refusal_of_exr(make_exr(3, 2, true, {{"A", kValues}})), "it has A"));
}

// Returns a header of one attribute, which says that it is this long and is not there.
std::string header_of_attribute(const std::string& type, std::uint32_t size) {
  std::string file("\x76\x2f\x31\x01\x02\0\0\0", 8);
  file += std::string("a\0", 2) + type + '\0';
  file.append(reinterpret_cast<const char*>(&size), sizeof size);
  return file + std::string(60, '\0');
}

TEST(ExrDepth, TakesNoMemoryForAttributesThatAreNotThere) {
  for (const char* type : {"opaque", "string", "floatvector", "preview", "chlist", "of others"}) {
    for (const std::uint32_t size : {61U, 0x7fffffffU, 0xffffffffU})
      EXPECT_TRUE(says(refusal_of_exr(header_of_attribute(type, size)), "longer than the file"))
          << type;
  }
}

// OpenEXR reads a list of channels to its own end, and takes what follows for the next attribute.
TEST(ExrDepth, RefusesAttributesThatAreLongerThanTheirValue) {
  std::string file = make_exr(3, 2, false, {{"Z", kValues}});
  const std::size_t size = file.find("chlist") + 7;
  file[size] = static_cast<char>(file[size] + 4);
  file.insert(size + 4 + 19, "abc", 4);
  EXPECT_TRUE(says(refusal_of_exr(file), "has 23 bytes, its value 19")) << refusal_of_exr(file);
}

TEST(ExrDepth, TakesNoMoreMemoryForAnImageThanItsFileMayAskFor) {
  const std::string sound = make_exr(3, 2, false, {{"Z", kValues}});
  const auto with_window = [&](const std::string& name, std::int32_t right, std::int32_t bottom) {
    std::string file = sound;
    const std::size_t value = file.find(name + '\0' + "box2i") + name.size() + 1 + 6 + 4;
    file.replace(value + 8, 4, reinterpret_cast<const char*>(&right), 4);
    file.replace(value + 12, 4, reinterpret_cast<const char*>(&bottom), 4);
    return file;
  };
  EXPECT_TRUE(
      says(refusal_of_exr(with_window("dataWindow", 8191, 8191)), "does not fit into the file"));
  EXPECT_TRUE(says(refusal_of_exr(with_window("dataWindow", 268'000'000, 0)), "MB of memory"));
  EXPECT_TRUE(says(refusal_of_exr(with_window("displayWindow", 8191, 8191)), "MB of memory"));
  EXPECT_NE(refusal_of_exr(with_window("dataWindow", 0x7fffffff, 0x7fffffff)), "");
}

// Without one, OpenEXR would take a value of its own: rows by sixteens, of a file of single rows.
TEST(ExrDepth, RefusesAHeaderThatLacksWhatDecidesItsMemory) {
  for (const std::string name : {"channels", "compression", "dataWindow", "displayWindow"}) {
    std::string file = make_exr(3, 2, false, {{"Z", kValues}});
    file[file.find(name + '\0')] = 'x';
    EXPECT_TRUE(says(refusal_of_exr(file), "attribute " + name + " is missing"))
        << refusal_of_exr(file);
  }
}

TEST(ExrDepth, DamageIsRefused) {
  expect_damage_is_refused(make_exr(3, 2, true, {{"Y", kValues}}), 300,
                           [](auto bytes) { parse_exr_depth(bytes, "file", ""); });
}

}  // namespace
}  // namespace vpm
