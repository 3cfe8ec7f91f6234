#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfPartType.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libvpm/core/error.h"
#include "libvpm/file/text.h"
#include "libvpm/import/depth_files.h"
#include "libvpm/import/exr_channels.h"

namespace vpm {
namespace {

// Returns the number of pixels from `low` to `high`, both included; 0 if there is none.
std::uint64_t extent(std::int64_t low, std::int64_t high) {
  return high < low ? 0 : static_cast<std::uint64_t>(high - low) + 1;
}

struct Window {
  std::int32_t left = 0, top = 0, right = -1, bottom = -1;

  std::uint64_t width() const { return extent(left, right); }
  std::uint64_t height() const { return extent(top, bottom); }
};

// Holds what a part's header tells of the memory that reading it takes.
struct Part {
  Window data, display;
  std::uint8_t compression = 0;
  std::uint64_t bytes_per_pixel = 0;
  std::uint64_t chunks = 0;                       // as declared; 0 if it is not
  std::set<std::string_view> names;               // all attributes
  std::uint32_t tile_width = 0, tile_height = 0;  // 0: stored in rows

  bool is_tiled() const { return tile_width > 0 && tile_height > 0; }
};

constexpr std::size_t kAfterChannelName = 16;  // type, flags, sampling

// Lengths of values by the names of their types; those that are not here say their length.
constexpr std::pair<std::string_view, std::uint64_t> kLengths[] = {
    {"box2i", 16},    {"box2f", 16},   {"int", 4},      {"float", 4},
    {"double", 8},    {"v2i", 8},      {"v2f", 8},      {"v2d", 16},
    {"v3i", 12},      {"v3f", 12},     {"v3d", 24},     {"m33f", 36},
    {"m33d", 72},     {"m44f", 64},    {"m44d", 128},   {"compression", 1},
    {"lineOrder", 1}, {"envmap", 1},   {"tiledesc", 9}, {"deepImageState", 1},
    {"keycode", 28},  {"rational", 8}, {"timecode", 8}, {"chromaticities", 32}};

// Returns the rows that are compressed together.
std::uint64_t rows_per_chunk(std::uint8_t compression) {
  constexpr std::array<std::uint64_t, 10> kRows{1, 1, 1, 16, 32, 16, 32, 32, 32, 256};
  return compression < kRows.size() ? kRows[compression] : 1;
}

// Checks the header of a file before OpenEXR sees it, which takes memory for what a header declares
// before it reads it.
class HeaderCheck {
 public:
  explicit HeaderCheck(std::span<const std::byte> bytes) : text_(file::as_text(bytes)) {}

  void run() {
    constexpr std::size_t kMagicAndVersion = 8;
    constexpr std::uint8_t kMultiPart = 0x10;  // in the second byte of the version
    if (text_.size() < kMagicAndVersion) return;
    const bool has_parts = (static_cast<std::uint8_t>(text_[5]) & kMultiPart) != 0;
    at_ = kMagicAndVersion;
    do {
      Part part;
      read_attributes(part);
      check(part);
    } while (has_parts && at_ < text_.size() && text_[at_] != 0);
  }

 private:
  void read_attributes(Part& part) {
    for (;;) {
      const std::string_view name = next_string();
      if (name.empty()) return;
      const std::string_view type = next_string();
      const std::uint32_t size = next<std::uint32_t>();
      if (size > text_.size() - at_)
        throw std::runtime_error("attribute " + file::shown(name) + " of " + std::to_string(size) +
                                 " bytes is longer than the file; it is damaged");
      const std::string_view value = text_.substr(at_, size);
      check_length(name, type, value);
      keep(part, name, value);
      part.names.insert(name);
      at_ += size;
    }
  }

  // Throws if a value's declared length is not that of its type. OpenEXR reads values of most types
  // to an end of their own, and would find other attributes behind it than those that are checked
  // here.
  static void check_length(std::string_view name, std::string_view type, std::string_view value) {
    std::uint64_t length = value.size();
    for (const auto& [known, bytes] : kLengths)
      if (type == known) length = bytes;
    if (type == "chlist") length = channels_of(value).length;
    if (type == "preview")
      length = 8 + 4 * std::uint64_t{as<std::uint32_t>(value)} *
                       as<std::uint32_t>(value.substr(std::min<std::size_t>(value.size(), 4)));
    if (length != value.size())
      throw std::runtime_error("attribute " + file::shown(name) + " has " +
                               std::to_string(value.size()) + " bytes, its value " +
                               std::to_string(length) + "; it is damaged");
  }

  struct Channels {
    std::uint64_t length = 0;  // bytes to the empty name that ends the list, which is a part of it
    std::uint64_t bytes_per_pixel = 0;
  };
  static Channels channels_of(std::string_view list) {
    Channels channels;
    std::size_t at = 0;
    while (at < list.size() && list[at] != 0) {
      const std::size_t end = list.find('\0', at);
      if (end == list.npos) return {list.size() + 1, channels.bytes_per_pixel};
      const auto type = as<std::uint32_t>(list.substr(end + 1));
      channels.bytes_per_pixel += type == 1 ? 2 : 4;  // 1 is HALF
      at = end + 1 + kAfterChannelName;
    }
    channels.length = at + 1;
    return channels;
  }

  static void keep(Part& part, std::string_view name, std::string_view value) {
    if (name == "dataWindow") part.data = as<Window>(value);
    if (name == "displayWindow") part.display = as<Window>(value);
    if (name == "compression") part.compression = as<std::uint8_t>(value);
    if (name == "chunkCount") part.chunks = as<std::uint32_t>(value);
    if (name == "channels") part.bytes_per_pixel = channels_of(value).bytes_per_pixel;
    if (name == "tiles") {
      part.tile_width = as<std::uint32_t>(value);
      part.tile_height = as<std::uint32_t>(value.substr(std::min<std::size_t>(value.size(), 4)));
    }
  }

  // Throws if an attribute is missing that the format requires. OpenEXR takes a value of its own
  // for it, which may ask for more memory than what is declared.
  static void check_names(const Part& part) {
    for (const char* name : {"channels", "compression", "dataWindow", "displayWindow"})
      if (!part.names.contains(name))
        throw std::runtime_error("attribute " + std::string(name) + " is missing; it is damaged");
  }

  void check(const Part& part) const {
    check_names(part);
    const std::uint64_t width = part.data.width(), height = part.data.height();
    // Sums with floating point, which no declared size overflows.
    const auto as_double = [](std::uint64_t n) { return static_cast<double>(n); };
    double chunks = as_double(part.chunks), pixels_at_once = 0;
    if (part.is_tiled()) {
      const double across = as_double((width + part.tile_width - 1) / part.tile_width),
                   down = as_double((height + part.tile_height - 1) / part.tile_height);
      chunks = std::max(chunks, across * down);
      pixels_at_once = as_double(part.tile_width) * as_double(part.tile_height);
    } else {
      const std::uint64_t rows = rows_per_chunk(part.compression);
      chunks = std::max(chunks, as_double((height + rows - 1) / rows));
      pixels_at_once = as_double(width) * as_double(rows);
    }
    constexpr double kLeastBytesOfChunk = 16;  // its place in the table, its row and its size
    if (chunks * kLeastBytesOfChunk > as_double(text_.size()))
      throw std::runtime_error("an image of " + std::to_string(width) + " x " +
                               std::to_string(height) +
                               " pixels does not fit into the file; it is truncated or damaged");
    constexpr double kBuffers = 2;  // compressed and not
    const double memory =
        sizeof(float) * (as_double(width) * as_double(height) +
                         as_double(part.display.width()) * as_double(part.display.height())) +
        kBuffers * pixels_at_once * as_double(part.bytes_per_pixel);
    if (memory > as_double(file::most_memory(text_.size())))
      throw std::runtime_error("it asks for " + std::to_string(std::uint64_t(memory / 1e6)) +
                               " MB of memory, a file of its size for " +
                               std::to_string(file::most_memory(text_.size()) / 1'000'000) +
                               " at most; it is damaged, or store it with less compression");
  }

  std::string_view next_string() {
    const std::size_t end = text_.find('\0', std::min(at_, text_.size()));
    if (end == text_.npos) throw std::runtime_error("the file is truncated");
    const std::string_view found = text_.substr(at_, end - at_);
    at_ = end + 1;
    return found;
  }

  template <class Value>
  Value next() {
    if (text_.size() - at_ < sizeof(Value)) throw std::runtime_error("the file is truncated");
    at_ += sizeof(Value);
    return as<Value>(text_.substr(at_ - sizeof(Value)));
  }

  // Returns the first bytes as a value; zeros if there are not enough, which OpenEXR refuses.
  template <class Value>
  static Value as(std::string_view bytes) {
    Value value{};
    if (bytes.size() >= sizeof value) std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

// Throws std::runtime_error if an attribute is longer than the file or than its value, if the image
// cannot have its rows or tiles in the file, or if reading it would take more memory than a file of
// this size may ask for (file::most_memory). Passes over what OpenEXR itself refuses.
void check_exr_header(std::span<const std::byte> bytes) {
  HeaderCheck(bytes).run();
}

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

// Returns the first pixel in which the images differ, "(3, 4)"; empty if there is none.
std::string difference(const std::vector<float>& a, const RawDepth& image) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (same_measurement(a[i], image.values[i])) continue;
    return "(" + std::to_string(i % image.width) + ", " + std::to_string(i / image.width) + ")";
  }
  return "";
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
    const auto other = part.in_display_window(part.read(channels[chosen[k]].name.name));
    const std::string pixel = difference(other.values, image);
    if (!pixel.empty()) refuse_difference(names, chosen, pixel, name);
  }
  const std::string note = words_of_choice(names, chosen);
  if (!note.empty()) image.remarks.push_back({false, note});
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
