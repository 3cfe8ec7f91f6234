#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <cmath>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/exr_channels.h"
#include "libvpm/import/exr_header.h"

namespace vpm {
namespace {

using Imath::Box2i;

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

struct Channel {
  int part = 0;
  ExrChannelName name;
};

// Returns the channels of all parts but those of deep images, which hold many values for a pixel.
std::vector<Channel> channels_of(const Imf::MultiPartInputFile& file) {
  std::vector<Channel> channels;
  bool has_deep_part = false;
  for (int part = 0; part < file.parts(); ++part) {
    const Imf::Header& header = file.header(part);
    const bool is_deep = header.hasType() && Imf::isDeepData(header.type());
    has_deep_part = has_deep_part || is_deep;
    if (is_deep) continue;
    const std::string name = header.hasName() ? header.name() : std::to_string(part);
    const Imf::ChannelList& list = header.channels();
    for (auto it = list.begin(); it != list.end(); ++it)
      channels.push_back({part, {file.parts() > 1 ? name : "", it.name()}});
  }
  if (channels.empty() && has_deep_part)
    throw std::runtime_error("its pixels are deep, with many values each; flatten it first");
  return channels;
}

// Reads the pixels of a channel that are in the part's data window.
class PartReader {
 public:
  PartReader(Imf::MultiPartInputFile& file, int part, const std::string& name)
      : file_(file, part), stored_(file_.header().dataWindow()), name_(name) {
    check_image_size(width(), extent(stored_.min.y, stored_.max.y), name);
  }

  std::vector<float> read(const std::string& channel) {
    const Imf::Channel* found = file_.header().channels().findChannel(channel);
    if (found->xSampling != 1 || found->ySampling != 1)
      throw std::runtime_error("channel " + file::shown(channel) +
                               " has not a value at every pixel");
    std::vector<float> values(width() * extent(stored_.min.y, stored_.max.y));
    Imf::FrameBuffer buffer;
    buffer.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(), stored_, sizeof(float),
                                            sizeof(float) * width()));
    file_.setFrameBuffer(buffer);
    file_.readPixels(stored_.min.y, stored_.max.y);
    return values;
  }

  // Returns the values in the display window, to which intrinsics refer; 0 where nothing is stored.
  RawDepth in_display_window(std::vector<float> values) const {
    const Box2i& display = file_.header().displayWindow();
    RawDepth image;
    const std::uint64_t columns = extent(display.min.x, display.max.x),
                        rows = extent(display.min.y, display.max.y);
    check_image_size(columns, rows, name_);
    image.width = static_cast<std::uint32_t>(columns);
    image.height = static_cast<std::uint32_t>(rows);
    if (display == stored_) {
      image.values = std::move(values);
      return image;
    }
    image.values.resize(columns * rows);
    for (int y = std::max(display.min.y, stored_.min.y);
         y <= std::min(display.max.y, stored_.max.y); ++y) {
      for (int x = std::max(display.min.x, stored_.min.x);
           x <= std::min(display.max.x, stored_.max.x); ++x) {
        image.values[extent(display.min.y, y - 1) * columns + extent(display.min.x, x - 1)] =
            values[extent(stored_.min.y, y - 1) * width() + extent(stored_.min.x, x - 1)];
      }
    }
    image.remarks.push_back({false, words_of_windows(display)});
    return image;
  }

  bool has_integers(const std::string& channel) const {
    return file_.header().channels().findChannel(channel)->type == Imf::UINT;
  }

 private:
  std::uint64_t width() const { return extent(stored_.min.x, stored_.max.x); }

  std::string words_of_windows(const Box2i& display) const {
    const auto size = [](const Box2i& box) {
      return std::to_string(extent(box.min.x, box.max.x)) + " x " +
             std::to_string(extent(box.min.y, box.max.y));
    };
    return "its display window of " + size(display) +
           " pixels is read, to which intrinsics refer; of it, the " + size(stored_) +
           " pixels from (" + std::to_string(std::int64_t{stored_.min.x} - display.min.x) + ", " +
           std::to_string(std::int64_t{stored_.min.y} - display.min.y) + ") on are stored";
  }

  Imf::InputPart file_;
  Box2i stored_;
  const std::string& name_;
};

bool same_measurement(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void expect_equal(const std::vector<float>& a, const std::vector<float>& b, const RawDepth& image,
                  const std::string& name) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (same_measurement(a[i], b[i])) continue;
    refuse("R, G and B differ at pixel (" + std::to_string(i % image.width) + ", " +
               std::to_string(i / image.width) + "): a colour image, no depth",
           name);
  }
}

RawDepth read_exr(std::span<const std::byte> bytes, const std::string& name,
                  const std::string& asked) {
  check_exr_header(bytes);
  MemoryStream stream(bytes, name);
  Imf::MultiPartInputFile file(stream, 0);
  const std::vector<Channel> channels = channels_of(file);
  std::vector<ExrChannelName> names;
  for (const Channel& channel : channels) names.push_back(channel.name);
  const std::vector<std::size_t> chosen = depth_channels(names, asked, name);
  const Channel& first = channels[chosen.front()];
  PartReader part(file, first.part, name);
  RawDepth image = part.in_display_window(part.read(first.name.name));
  image.are_integers = part.has_integers(first.name.name);
  for (std::size_t k = 1; k < chosen.size(); ++k) {
    expect_equal(part.in_display_window(part.read(channels[chosen[k]].name.name)).values,
                 image.values, image, name);
  }
  if (chosen.size() > 1) {
    image.remarks.push_back(
        {false, "no channel's name says depth: R, G and B, which are equal, are taken for it"});
  } else if (channels.size() > 1) {
    image.remarks.push_back({false, "depth is its channel " + file::shown(full_name(first.name))});
  }
  return image;
}

}  // namespace

RawDepth parse_exr_depth(std::span<const std::byte> bytes, const std::string& name,
                         const std::string& channel) {
  try {
    return read_exr(bytes, name, channel);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& fault) {
    refuse(std::string("not a depth image in OpenEXR: ") + file::shown(fault.what(), 200), name);
  }
}

}  // namespace vpm
