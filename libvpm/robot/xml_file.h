// XML files of robots, URDF and SRDF, as trees of elements by TinyXML, which urdfdom needs too.
#pragma once

#include <tinyxml.h>

#include <string>
#include <vector>

namespace vpm {

// Returns the text of a file, "-" of standard input.
std::string text_of_xml(const std::string& path);

// Returns the attribute; an empty text if it is not there.
std::string attribute(const TiXmlElement& element, const char* name);

class XmlFile {
 public:
  // Parses the text of a file. Throws Error(refused), naming the line, if it is no XML, or its root
  // has another name; `what` says what it should be.
  XmlFile(const std::string& path, const std::string& text, const char* root, const char* what);

  // Returns the children of the root with this name.
  std::vector<const TiXmlElement*> children(const char* name) const;
  TiXmlDocument& document() { return document_; }

 private:
  TiXmlDocument document_;
};

}  // namespace vpm
