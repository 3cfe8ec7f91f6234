cmake_minimum_required(VERSION 3.25)
# cmake -DFOLDER=… -DTHREE=… -DCONTROLS=… -DOUTPUT=… -P embed.cmake: page.html with all that it needs as C++ strings.
# Without THREE both strings are empty.
set(head "")
set(tail "")
if(THREE)
  file(READ ${FOLDER}/page.html page)
  string(REGEX MATCHALL "@[a-z_]+\\.(css|js)@" parts "${page}")
  list(TRANSFORM parts REPLACE "@" "")
  foreach(part ${parts})
    file(READ ${FOLDER}/${part} text)
    string(REPLACE "@${part}@" "${text}" page "${page}")
  endforeach()
  file(READ ${FOLDER}/three_license.txt license)
  file(READ ${THREE} three)
  file(READ ${CONTROLS} controls)
  foreach(text "${three}" "${controls}")
    string(FIND "${text}" "</script" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "the drawing library holds </script, which a page cannot embed")
    endif()
  endforeach()
  string(REPLACE "@LICENSE@" "${license}" page "${page}")
  string(REPLACE "@THREE@" "${three}" page "${page}")
  string(REPLACE "@CONTROLS@" "${controls}" page "${page}")
  string(FIND "${page}" "@DATA@" at)
  string(SUBSTRING "${page}" 0 ${at} head)
  math(EXPR at "${at} + 6")
  string(SUBSTRING "${page}" ${at} -1 tail)
endif()
file(WRITE ${OUTPUT} "#include \"libvpm/view/page.h\"\n
namespace vpm::view {\n
constexpr char kHead[] = R\"vpm-page(${head})vpm-page\";
constexpr char kTail[] = R\"vpm-page(${tail})vpm-page\";
const std::string_view kPageHead(kHead, sizeof kHead - 1), kPageTail(kTail, sizeof kTail - 1);\n
}  // namespace vpm::view\n")
