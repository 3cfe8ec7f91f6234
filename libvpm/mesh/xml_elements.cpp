#include "libvpm/mesh/xml_elements.h"

#include <expat.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <new>
#include <type_traits>

namespace vpm {
namespace {

constexpr std::string_view kBlank = " \t\r\n";
constexpr std::size_t kMostText = 256;

std::string_view without_prefix(std::string_view name) {
  return name.substr(name.rfind(':') + 1);  // npos + 1 is 0
}

// Holds what expat's functions are given.
struct Walk {
  const XmlEvents& events;
  XML_Parser parser;
  std::vector<std::string> names;
  std::string text;
  std::exception_ptr fault;

  // Keeps exceptions from expat, which is C.
  template <class Work>
  void run(const Work& work) {
    if (fault) return;
    try {
      work();
    } catch (...) {
      fault = std::current_exception();
      XML_StopParser(parser, XML_FALSE);
    }
  }
};

void begin_element(void* data, const char* name, const char** attributes) {
  Walk& walk = *static_cast<Walk*>(data);
  walk.run([&] {
    walk.names.emplace_back(without_prefix(name));
    walk.text.clear();
    walk.events.begin(XmlElement(walk.names, attributes));
  });
}

void end_element(void* data, const char*) {
  Walk& walk = *static_cast<Walk*>(data);
  walk.run([&] {
    const char* const none = nullptr;
    if (walk.events.end) walk.events.end(XmlElement(walk.names, &none), trimmed(walk.text));
    walk.names.pop_back();
    walk.text.clear();
  });
}

void take_text(void* data, const char* text, int size) {
  Walk& walk = *static_cast<Walk*>(data);
  walk.run([&] {
    const std::size_t room = kMostText - std::min(walk.text.size(), kMostText);
    walk.text.append(text, std::min(static_cast<std::size_t>(size), room));
  });
}

// Reads encodings that expat does not know as Latin-1: names and numbers are ASCII in all of them.
int take_encoding(void*, const char*, XML_Encoding* encoding) {
  for (int k = 0; k < 256; ++k) encoding->map[k] = k;
  encoding->data = nullptr;
  encoding->convert = nullptr;
  encoding->release = nullptr;
  return XML_STATUS_OK;
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return "";
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

bool XmlElement::is_in(std::initializer_list<std::string_view> around) const {
  return around.size() <= depth() &&
         std::equal(around.begin(), around.end(),
                    names_.end() - 1 - static_cast<std::ptrdiff_t>(around.size()));
}

std::optional<std::string_view> XmlElement::attribute(std::string_view name) const {
  for (const char* const* pair = attributes_; *pair != nullptr; pair += 2)
    if (without_prefix(pair[0]) == name) return trimmed(pair[1]);
  return std::nullopt;
}

std::string XmlElement::text_of(std::string_view name) const {
  return std::string(attribute(name).value_or(""));
}

std::optional<std::string> read_xml(std::string_view text, const XmlEvents& events) {
  constexpr std::size_t kMostAtOnce = 1 << 24;  // expat counts bytes in an int
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser(
      XML_ParserCreate(nullptr), XML_ParserFree);
  if (!parser) throw std::bad_alloc();
  Walk walk{events, parser.get(), {}, {}, {}};
  XML_SetUserData(parser.get(), &walk);
  XML_SetElementHandler(parser.get(), begin_element, end_element);
  XML_SetCharacterDataHandler(parser.get(), take_text);
  XML_SetUnknownEncodingHandler(parser.get(), take_encoding, nullptr);
  do {
    const std::string_view part = text.substr(0, kMostAtOnce);
    text.remove_prefix(part.size());
    const XML_Status status =
        XML_Parse(parser.get(), part.data(), static_cast<int>(part.size()), text.empty());
    if (walk.fault) std::rethrow_exception(walk.fault);
    if (status == XML_STATUS_ERROR) {
      if (XML_GetErrorCode(parser.get()) == XML_ERROR_NO_MEMORY) throw std::bad_alloc();
      return std::string(XML_ErrorString(XML_GetErrorCode(parser.get()))) + " in line " +
             std::to_string(XML_GetCurrentLineNumber(parser.get()));
    }
  } while (!text.empty());
  return std::nullopt;
}

}  // namespace vpm
