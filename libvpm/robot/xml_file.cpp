#include "libvpm/robot/xml_file.h"

#include "libvpm/core/error.h"
#include "libvpm/file/stream.h"
#include "libvpm/file/text.h"

namespace vpm {

std::string text_of_xml(const std::string& path) {
  const std::vector<std::byte> bytes = file::read_all(path);
  return std::string(file::without_byte_order_mark(file::as_text(bytes)));
}

std::string attribute(const TiXmlElement& element, const char* name) {
  const char* const text = element.Attribute(name);
  return text == nullptr ? "" : text;
}

XmlFile::XmlFile(const std::string& path, const std::string& text, const char* root,
                 const char* what) {
  document_.Parse(text.c_str());
  if (document_.Error())
    refuse(document_.ErrorRow() == 0
               ? "this is no XML"
               : "this is no XML from line " + std::to_string(document_.ErrorRow()) + " on",
           path, std::string("give ") + what);
  const TiXmlElement* const element = document_.RootElement();
  if (element == nullptr || element->ValueStr() != root)
    refuse(std::string("its root is ") +
               (element == nullptr ? "missing" : "<" + file::shown(element->ValueStr()) + ">") +
               ", not <" + root + ">",
           path, std::string("give ") + what);
}

std::vector<const TiXmlElement*> XmlFile::children(const char* name) const {
  std::vector<const TiXmlElement*> found;
  const TiXmlElement* const root = document_.RootElement();
  for (const TiXmlElement* element = root->FirstChildElement(name); element != nullptr;
       element = element->NextSiblingElement(name))
    found.push_back(element);
  return found;
}

}  // namespace vpm
