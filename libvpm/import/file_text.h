// Reads headers and numbers of text-based formats from a file in memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string_view> split_words(std::string_view line);

// Returns the whole word as a number, also "nan" and "inf"; empty if it is none.
std::optional<double> to_number(std::string_view word);
std::optional<std::uint64_t> to_count(std::string_view word);

// Reads a file line by line or word by word.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  // Returns the next line without its end ("\n" or "\r\n"); empty at the end of the file.
  std::optional<std::string_view> line();
  // Returns the words of the next line that has any; none at the end of the file.
  std::vector<std::string_view> row();
  // Returns the next word across line ends; empty at the end of the file.
  std::string_view word();

  std::size_t offset() const { return at_; }
  std::size_t remaining() const { return text_.size() - at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
};

// Type of a binary number: kind 'F' (float), 'I' (signed), 'U' (unsigned); size in bytes.
struct ScalarType {
  char kind = 0;
  std::uint8_t size = 0;  // 0 stands for an unknown type
};
bool is_known(ScalarType type);
double read_scalar(const std::byte* from, ScalarType type, bool big_endian);

}  // namespace vpm
