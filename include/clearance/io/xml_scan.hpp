// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A quick look at an XML file before a parser that recurses gets it: depth, order, and single attributes.

#include <clearance/io/error.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace clearance::io {

/// A start tag: its element, the text of its attributes, what follows up to the next end tag, how many elements are
/// around it, and its line.
struct xml_tag {
  std::string_view element, attributes, content;
  std::size_t depth = 0, line = 0;

  /// The value of an attribute as it is written, or nothing.
  std::string_view attribute(std::string_view name) const {
    for (std::size_t at = attributes.find(name); at != attributes.npos; at = attributes.find(name, at + 1)) {
      const bool starts = at > 0 && std::string_view(" \t\r\n").find(attributes[at - 1]) != std::string_view::npos;
      std::size_t next = attributes.find_first_not_of(" \t\r\n", at + name.size());
      if (!starts || next == attributes.npos || attributes[next] != '=') continue;
      next = attributes.find_first_not_of(" \t\r\n", next + 1);
      if (next == attributes.npos || (attributes[next] != '"' && attributes[next] != '\'')) continue;
      const std::size_t end = attributes.find(attributes[next], next + 1);
      return end == attributes.npos ? std::string_view() : attributes.substr(next + 1, end - next - 1);
    }
    return {};
  }
};

/// Shows `visit` every start tag in order. Zero bytes, unclosed tags and more than 200 elements inside one another are
/// errors; the rest of the grammar is left to the parser.
template <class Visit>
void scan_xml(std::string_view text, const std::string& file, Visit visit) {
  if (text.find('\0') != text.npos) refuse(file, "is not XML: it has zero bytes");
  std::size_t depth = 0, line = 1, counted = 0;
  for (std::size_t at = text.find('<'); at != text.npos; at = text.find('<', at)) {
    line += std::size_t(std::count(text.begin() + std::ptrdiff_t(counted), text.begin() + std::ptrdiff_t(at), '\n'));
    counted = at;
    const auto skip = [&](std::string_view opening, std::string_view closing) {
      if (!text.substr(at).starts_with(opening)) return false;
      const std::size_t end = text.find(closing, at + opening.size());
      if (end == text.npos) refuse(file, "is cut short: no \"" + std::string(closing) + "\" follows", line);
      at = end + closing.size();
      return true;
    };
    if (skip("<!--", "-->") || skip("<![CDATA[", "]]>") || skip("<?", "?>") || skip("<!", ">")) continue;
    std::size_t end = at + 1;  // the '>' that is in no quotes
    for (char quote = 0; end < text.size() && (quote || text[end] != '>'); ++end)
      if (quote ? text[end] == quote : text[end] == '"' || text[end] == '\'') quote = quote ? 0 : text[end];
    if (end == text.size()) refuse(file, "is cut short: a tag is not closed", line);
    std::string_view tag = text.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag.starts_with('/')) {
      if (depth == 0) refuse(file, "closes an element that is not open", line);
      --depth;
      continue;
    }
    const bool closed = tag.ends_with('/');
    if (closed) tag.remove_suffix(1);
    const std::size_t name = std::min(tag.find_first_of(" \t\r\n"), tag.size());
    const std::string_view content = closed ? std::string_view() : text.substr(at, text.find("</", at) - at);
    visit(xml_tag{tag.substr(0, name), tag.substr(name), content, depth, line});
    if (!closed && ++depth > 200) refuse(file, "has more than 200 elements inside one another", line);
  }
  if (depth > 0) refuse(file, "is cut short: " + std::to_string(depth) + " elements are not closed");
}

}  // namespace clearance::io
