#include "libvpm/mesh/scene_xml.h"

namespace vpm {
namespace {

constexpr std::string_view kBlank = " \t\r\n";

}  // namespace

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return "";
  return text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
}

// Goes behind the end of what begins so here; true if it does.
bool XmlTags::passes_over(std::string_view begin, std::string_view end) {
  if (!text_.substr(at_).starts_with(begin)) return false;
  const std::size_t found = text_.find(end, at_ + begin.size());
  at_ = found == text_.npos ? text_.size() : found + end.size();
  return true;
}

// Returns the place of the '>' that ends a tag, which may stand in quotes before.
std::size_t XmlTags::end_of_tag(std::size_t at) const {
  while (at < text_.size() && text_[at] != '>') {
    if (text_[at] == '"' || text_[at] == '\'') at = text_.find(text_[at], at + 1);
    if (at == text_.npos) return text_.npos;
    ++at;
  }
  return at < text_.size() ? at : text_.npos;
}

bool XmlTags::next() {
  for (;;) {
    at_ = text_.find('<', at_);
    if (at_ == text_.npos) return false;
    if (passes_over("<!--", "-->") || passes_over("<![CDATA[", "]]>") || passes_over("<?", "?>"))
      continue;
    const std::size_t end = end_of_tag(at_);
    if (end == text_.npos) return false;
    std::string_view tag = text_.substr(at_ + 1, end - at_ - 1);
    at_ = end + 1;
    if (tag.starts_with('!')) continue;
    is_end_ = tag.starts_with('/');
    if (is_end_) tag.remove_prefix(1);
    const bool is_empty = !is_end_ && tag.ends_with('/');
    if (is_empty) tag.remove_suffix(1);
    name_ = tag.substr(0, tag.find_first_of(kBlank));
    attributes_ = tag.substr(name_.size());
    name_ = name_.substr(name_.rfind(':') + 1);  // npos + 1 is 0
    if (is_end_ && open_ > 0) --open_;
    depth_ = open_;
    if (!is_end_ && !is_empty) ++open_;
    return true;
  }
}

std::string_view XmlTags::text() const {
  const std::string_view rest = text_.substr(at_);
  return trimmed(rest.substr(0, rest.find('<')));
}

template <class Matches>
std::optional<std::string_view> XmlTags::find_attribute(const Matches& matches) const {
  std::string_view rest = attributes_;
  for (;;) {
    const std::size_t equals = rest.find('=');
    if (equals == rest.npos) return std::nullopt;
    const std::string_view name = trimmed(rest.substr(0, equals));
    const std::size_t quote = rest.find_first_not_of(kBlank, equals + 1);
    if (quote == rest.npos || (rest[quote] != '"' && rest[quote] != '\'')) return std::nullopt;
    const std::size_t end = rest.find(rest[quote], quote + 1);
    if (end == rest.npos) return std::nullopt;
    if (matches(name)) return trimmed(rest.substr(quote + 1, end - quote - 1));
    rest.remove_prefix(end + 1);
  }
}

std::optional<std::string_view> XmlTags::attribute(std::string_view name) const {
  return find_attribute([&](std::string_view written) { return written == name; });
}

std::optional<std::string_view> XmlTags::prefixed_attribute(std::string_view name) const {
  return find_attribute([&](std::string_view written) {
    const std::size_t colon = written.find(':');
    return colon != written.npos && written.substr(colon + 1) == name;
  });
}

}  // namespace vpm
