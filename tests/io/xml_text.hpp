// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "io/xml.hpp"

#include <string>

/// Text as XML has it. A blank that an attribute would lose is written by its number.
inline std::string escaped(const std::string& text) {
  std::string made;
  for (const char c : text)
    if (c == '&' || c == '<' || c == '>' || c == '"' || (c >= 0 && c < ' '))
      made += "&#" + std::to_string(int(c)) + ';';
    else
      made += c;
  return made;
}

/// The document of an element. What stands between its children comes before them.
inline std::string xml_text(const clearance::io::xml_element& e) {
  std::string made = "<" + e.name;
  for (const auto& [key, value] : e.attributes) made += " " + key + "=\"" + escaped(value) + "\"";
  made += ">" + escaped(e.text);
  for (const auto& child : e.children) made += xml_text(child);
  return made + "</" + e.name + ">";
}
