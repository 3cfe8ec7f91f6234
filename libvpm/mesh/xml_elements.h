// Walks over the elements of an XML text, by expat.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vpm {

// Element whose tag is being read. Names are given without prefixes, and are compared so.
class XmlElement {
 public:
  // Takes the names of the elements around it and its own, the root's first, and pairs of an
  // attribute's name and value that end in nullptr.
  XmlElement(const std::vector<std::string>& names, const char* const* attributes)
      : names_(names), attributes_(attributes) {}

  const std::string& name() const { return names_.back(); }
  // Returns the number of elements around this one: 0 for the root.
  std::size_t depth() const { return names_.size() - 1; }
  // True if the elements directly around this one have these names, the outermost first.
  bool is_in(std::initializer_list<std::string_view> around) const;
  // Returns the attribute's value without blanks around it; nothing where there is none.
  std::optional<std::string_view> attribute(std::string_view name) const;
  // Returns the attribute's value, or an empty text.
  std::string text_of(std::string_view name) const;

 private:
  const std::vector<std::string>& names_;
  const char* const* attributes_;
};

struct XmlEvents {
  std::function<void(const XmlElement&)> begin;
  // Is called where an element ends, with the first 256 bytes of the text behind its last tag. Its
  // attributes are gone. May be left out.
  std::function<void(const XmlElement&, std::string_view)> end;
};

// Calls the events in the order of the text, and returns what is wrong with the text, with its
// line; nothing if it is well-formed. An exception of an event ends the walk and is passed on.
std::optional<std::string> read_xml(std::string_view text, const XmlEvents& events);

// Returns the text without the blanks around it.
std::string_view trimmed(std::string_view text);

}  // namespace vpm
