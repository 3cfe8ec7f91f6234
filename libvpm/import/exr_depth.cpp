#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/import/depth_files.h"

namespace vpm {
namespace {

class MemoryStream : public Imf::IStream {
 public:
  MemoryStream(std::span<const std::byte> bytes, const std::string& name)
      : Imf::IStream(name.c_str()), bytes_(bytes) {}

  bool read(char to[], int count) override {
    const auto wanted = static_cast<std::uint64_t>(count);
    if (count < 0 || at_ > bytes_.size() || wanted > bytes_.size() - at_)
      throw std::runtime_error("the file is truncated");
    std::memcpy(to, bytes_.data() + at_, wanted);
    at_ += wanted;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t to) override { at_ = to; }

 private:
  std::span<const std::byte> bytes_;
  std::uint64_t at_ = 0;
};

// Returns the channels that hold depth, all equal: Z, Y, or R G B. Empty if there are none.
std::vector<std::string> depth_channels(const Imf::ChannelList& channels) {
  for (const char* single : {"Z", "Y"}) {
    if (channels.findChannel(single) != nullptr) return {single};
  }
  std::vector<std::string> rgb{"R", "G", "B"};
  for (const std::string& name : rgb) {
    if (channels.findChannel(name) == nullptr) return {};
  }
  return rgb;
}

std::string names_of(const Imf::ChannelList& channels) {
  std::string names;
  for (auto it = channels.begin(); it != channels.end(); ++it)
    names += (names.empty() ? "" : ", ") + std::string(it.name());
  return names.substr(0, 200);
}

bool same_measurement(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

std::vector<float> read_channel(Imf::InputFile& file, const std::string& channel,
                                const DepthImage& image) {
  const auto& window = file.header().dataWindow();
  const Imf::Channel* found = file.header().channels().findChannel(channel);
  if (found->type == Imf::UINT || found->xSampling != 1 || found->ySampling != 1)
    throw std::runtime_error("channel " + channel + " must be HALF or FLOAT at every pixel");
  std::vector<float> values(std::size_t{image.width} * image.height);
  Imf::FrameBuffer buffer;
  buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float),
                                          sizeof(float) * image.width));
  file.setFrameBuffer(buffer);
  file.readPixels(window.min.y, window.max.y);
  return values;
}

DepthImage read_exr(std::span<const std::byte> bytes, const std::string& name,
                    double units_per_metre) {
  MemoryStream stream(bytes, name);
  Imf::InputFile file(stream, 0);
  const auto& window = file.header().dataWindow();
  if (window != file.header().displayWindow())
    throw std::runtime_error("only part of the image is stored; write whole frames");
  const auto width = static_cast<std::uint64_t>(std::int64_t{window.max.x} - window.min.x + 1);
  const auto height = static_cast<std::uint64_t>(std::int64_t{window.max.y} - window.min.y + 1);
  check_image_size(width, height, name);
  DepthImage image{static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}};
  const std::vector<std::string> channels = depth_channels(file.header().channels());
  if (channels.empty()) {
    throw std::runtime_error("no channel Z or Y, nor R, G and B; it has " +
                             names_of(file.header().channels()));
  }
  image.depth = read_channel(file, channels[0], image);
  for (std::size_t c = 1; c < channels.size(); ++c) {
    const std::vector<float> other = read_channel(file, channels[c], image);
    for (std::size_t i = 0; i < other.size(); ++i) {
      if (!same_measurement(other[i], image.depth[i])) {
        throw std::runtime_error("R, G and B differ at pixel (" + std::to_string(i % width) + ", " +
                                 std::to_string(i / width) + "): a colour image, no depth");
      }
    }
  }
  for (float& depth : image.depth) depth = depth_in_metres(depth, units_per_metre);
  return image;
}

}  // namespace

DepthImage parse_exr_depth(std::span<const std::byte> bytes, const std::string& name,
                           double units_per_metre) {
  try {
    return read_exr(bytes, name, units_per_metre);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    refuse(std::string("not a depth image in OpenEXR: ") + fault.what(), name);
  }
}

}  // namespace vpm
