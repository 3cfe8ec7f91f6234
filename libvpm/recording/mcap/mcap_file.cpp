#include "libvpm/recording/mcap/mcap_file.h"

#include <lz4frame.h>
#include <zlib.h>
#include <zstd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string_view>
#include <utility>

#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm::mcap {
namespace {

namespace fs = std::filesystem;
constexpr std::string_view kMagic("\x89MCAP0\r\n", 8);
constexpr std::uint64_t kHead = 9;                             // bytes of a record: kind and length
constexpr std::uint64_t kMostChunk = std::uint64_t{1} << 30U;  // bytes, decompressed
enum class Kind : std::uint8_t { footer = 2, schema, channel, message, chunk, index = 8, end = 15 };

std::vector<std::byte> read_part(std::ifstream& file, std::uint64_t at, std::uint64_t count) {
  std::vector<std::byte> bytes(count);
  file.seekg(static_cast<std::streamoff>(at));
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(count));
  if (!file) refuse("it cannot be read, or has changed", {}, "copy it again");
  return bytes;
}

struct Head {
  Kind kind;
  std::uint64_t length;
};

Head take_head(ByteCursor& cursor) {
  const auto kind = static_cast<Kind>(cursor.number<std::uint8_t>());
  return {kind, cursor.number<std::uint64_t>()};
}

Head read_head(std::ifstream& file, std::uint64_t at) {
  const std::vector<std::byte> bytes = read_part(file, at, kHead);
  ByteCursor cursor(bytes);
  return take_head(cursor);
}

// Returns as much of a chunk's `size` bytes as comes out before what is compressed ends.
Records decompress(const std::string& compression, Bytes in, std::size_t size) {
  Records out{std::make_unique_for_overwrite<std::byte[]>(size), size};
  if (compression.empty()) {
    out.size = std::min(size, in.size());
    std::ranges::copy(in.first(out.size), out.bytes.get());
  } else if (compression == "lz4") {
    LZ4F_dctx* context = nullptr;
    LZ4F_createDecompressionContext(&context, LZ4F_VERSION);
    std::size_t taken = in.size();
    LZ4F_decompress(context, out.bytes.get(), &out.size, in.data(), &taken, nullptr);
    LZ4F_freeDecompressionContext(context);
  } else if (compression == "zstd") {
    ZSTD_DCtx* const context = ZSTD_createDCtx();
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.bytes.get(), size, 0};
    ZSTD_decompressStream(context, &to, &from);
    out.size = to.pos;
    ZSTD_freeDCtx(context);
  } else {
    refuse("its chunks are compressed by " + file::shown(compression), {},
           "record it with lz4 or zstd");
  }
  return out;
}

// Returns the records of a chunk, or, if the file ends in it, as much of them as is there. Throws
// Damage if they are not those that were written.
Records open_chunk(Bytes record, bool is_cut) {
  ByteCursor cursor(record);
  cursor.take(16);  // times of its first and last message
  const auto size = cursor.number<std::uint64_t>();
  const auto checksum = cursor.number<std::uint32_t>();
  const std::string compression = cursor.text();
  const auto stored = cursor.number<std::uint64_t>();
  if (size > std::min(kMostChunk, file::most_memory(record.size()))) throw Damage("a size");
  Records records =
      decompress(compression, cursor.take(is_cut ? std::min(stored, cursor.left()) : stored), size);
  const auto* const data = reinterpret_cast<const Bytef*>(records.bytes.get());
  if (!is_cut && (records.size != size || (checksum != 0 && crc32_z(0, data, size) != checksum)))
    throw Damage("a chunk");
  return records;
}

// Follows the records of a file, and counts those that are damaged.
struct Scan {
  const std::function<void(const Message&)>& see;
  std::size_t damaged = 0;
  std::map<std::uint16_t, std::string> types{};
  std::map<std::uint16_t, Channel> channels{};

  // Takes a record. If the file ends in it, only a chunk is of use.
  void take(Kind kind, Bytes record, const Place& place, bool is_cut) {
    try {
      ByteCursor cursor(record);
      if (kind == Kind::chunk && place.chunk == 0) take_chunk(record, place.offset, is_cut);
      if (is_cut) return;
      if (kind == Kind::schema) {
        const auto id = cursor.number<std::uint16_t>();
        types[id] = cursor.text();
      }
      if (kind == Kind::channel) take_channel(cursor);
      if (kind == Kind::message) take_message(cursor, place);
    } catch (const Damage&) {
      ++damaged;
    }
  }

  void take_channel(ByteCursor& cursor) {
    Channel& channel = channels[cursor.number<std::uint16_t>()];
    channel.type = types[cursor.number<std::uint16_t>()];
    channel.topic = cursor.text();
    channel.encoding = cursor.text();
  }

  void take_message(ByteCursor& cursor, Place place) {
    const auto channel = channels.find(cursor.number<std::uint16_t>());
    cursor.take(4);  // counts the messages of the channel
    const auto time = cursor.number<std::uint64_t>();
    cursor.take(8);  // when it was published
    place.offset += cursor.at();
    place.size = cursor.left();
    if (channel == channels.end()) throw Damage("a message of no channel");
    see({channel->second, time, cursor.take(place.size), place});
  }

  void take_chunk(Bytes record, std::uint64_t at, bool is_cut) {
    const Records records = open_chunk(record, is_cut);
    ByteCursor cursor({records.bytes.get(), records.size});
    while (cursor.left() >= kHead) {
      const auto [kind, length] = take_head(cursor);
      if (is_cut && length > cursor.left()) return;
      const Place place{at, cursor.at(), 0};
      take(kind, cursor.take(length), place, false);
    }
  }
};

}  // namespace

File::File(std::string path) : path_(std::move(path)) {
  std::error_code fault;
  size_ = fs::file_size(path_, fault);
  if (fault || size_ < kMagic.size()) refuse("cannot read " + path_ + ": " + fault.message());
}

Remarks File::scan(const std::function<void(const Message&)>& see) const try {
  std::ifstream input(path_, std::ios::binary);
  Scan scan{see};
  bool has_end = false, has_index = false, is_cut = false;
  std::uint64_t at = kMagic.size();
  while (size_ - at >= kHead && !is_cut) {
    const auto [kind, length] = read_head(input, at);
    if (kind == Kind{} || kind == Kind::footer) break;  // there is no kind 0
    has_end |= kind == Kind::end;
    has_index |= kind == Kind::index;
    const std::uint64_t body = at + kHead, there = std::min(length, size_ - body);
    is_cut = there < length;
    if (kind >= Kind::schema && kind <= Kind::chunk)
      scan.take(kind, read_part(input, body, there), {0, kind == Kind::chunk ? at : body, 0},
                is_cut);
    if (!is_cut || kind == Kind::chunk) at = body + there;
  }
  Remarks remarks;
  if (scan.damaged > 0)
    remarks.push_back({true,
                       "chunks or records that are damaged, or contradict others, and are left "
                       "out with all that they hold: " +
                           std::to_string(scan.damaged)});
  if (!has_end)
    remarks.push_back(
        {true, "it has no end, as where its recorder was stopped: it is read as far as it goes, " +
                   std::to_string(at) + " of " + std::to_string(size_) + " bytes"});
  else if (!has_index)
    remarks.push_back({false, "it has no index, and is read from its start"});
  return remarks;
} catch (const Error& fault) {
  throw Error(fault.kind(), fault.problem(), path_, fault.hint());
}

std::vector<std::byte> File::read(const Place& place) const {
  std::ifstream input(path_, std::ios::binary);
  if (place.chunk == 0) return read_part(input, place.offset, place.size);
  const std::lock_guard in_turn(busy_);
  if (opened_ != place.chunk) {
    const std::uint64_t body = place.chunk + kHead, length = read_head(input, place.chunk).length,
                        there = std::min(length, size_ - body);
    opened_ = 0;
    records_ = open_chunk(read_part(input, body, there), there < length);
    opened_ = place.chunk;
  }
  if (place.offset + place.size > records_.size) refuse("it has changed", {}, "copy it again");
  const std::byte* const from = records_.bytes.get() + place.offset;
  return {from, from + place.size};
}

std::vector<std::string> files_of(const std::string& path) {
  std::error_code fault;
  std::vector<std::string> files;
  if (fs::is_regular_file(path, fault)) {
    std::string start(kMagic.size(), ' ');
    std::ifstream(path, std::ios::binary).read(start.data(), std::ssize(start));
    if (start == kMagic) files = {path};
    return files;
  }
  for (fs::directory_iterator entry(path, fault), end; !fault && entry != end;
       entry.increment(fault))
    if (entry->path().extension() == ".mcap") files.push_back(entry->path().string());
  std::ranges::sort(files);
  return files;
}

}  // namespace vpm::mcap
