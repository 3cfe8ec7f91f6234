// Walks over the tags of an XML text, as far as headers of scenes need it.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace vpm {

// Passes over comments, CDATA, processing instructions and declarations, so that what stands there
// is never taken for an element. Damaged text ends the walk early; whether the file can be read is
// for the reader of the scene to say. The text must outlive this.
class XmlTags {
 public:
  explicit XmlTags(std::string_view text) : text_(text) {}

  // Goes to the next tag; false if there is none.
  bool next();

  // Returns the element's name without its prefix.
  std::string_view name() const { return name_; }
  bool is_end() const { return is_end_; }
  // Returns the number of elements around this one: 0 for the root.
  std::size_t depth() const { return depth_; }
  // Returns the text between this tag and the next one.
  std::string_view text() const;

  // Returns the value of an attribute, its name as written, without blanks around it; nothing where
  // the element has none.
  std::optional<std::string_view> attribute(std::string_view name) const;
  // Returns the same for an attribute of this name with any prefix, which it must have.
  std::optional<std::string_view> prefixed_attribute(std::string_view name) const;

 private:
  template <class Matches>
  std::optional<std::string_view> find_attribute(const Matches& matches) const;
  std::size_t end_of_tag(std::size_t at) const;
  bool passes_over(std::string_view begin, std::string_view end);

  std::string_view text_, name_, attributes_;
  std::size_t at_ = 0, depth_ = 0, open_ = 0;
  bool is_end_ = false;
};

// Returns the text without the blanks around it.
std::string_view trimmed(std::string_view text);

}  // namespace vpm
