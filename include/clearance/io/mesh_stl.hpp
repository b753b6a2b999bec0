// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What must hold of an STL file before assimp reads it: assimp passes over what is missing in a file cut short.

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace clearance::io {

/// Walks an ASCII STL file and counts its triangles, or ends with a sentence.
inline std::size_t check_ascii_stl(std::string_view rest, const std::string& file) {
  std::size_t triangles = 0, at = 0;
  std::string_view line;
  const auto next = [&] {  // the next word in small letters, empty at the end of the file
    std::string_view word;
    while ((word = take_word(line)).empty() && !rest.empty()) line = take_line(rest), ++at;
    std::string small(word);
    for (char& c : small) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
    return small;
  };
  const auto expect = [&](const char* wanted) {
    if (const std::string got = next(); got != wanted)
      refuse(file,
             std::string("expected \"") + wanted + "\", " +
                 (got.empty() ? "but the file ends" : "found \"" + got.substr(0, 40) + '"'),
             at);
  };
  const auto three_numbers = [&](bool must_be_finite) {
    for (int i = 0; i < 3; ++i) {
      const std::string word = next();
      const auto value = number<double>(word);
      if (!value) refuse(file, "expected a number, found \"" + word.substr(0, 40) + '"', at);
      if (must_be_finite && !std::isfinite(float(*value)))
        refuse(file, "a vertex has a coordinate that is not finite", at);
    }
  };
  for (std::string word = next(); !word.empty(); word = next()) {
    if (word != "solid") refuse(file, "expected \"solid\", found \"" + word.substr(0, 40) + '"', at);
    line = {};  // its name
    for (word = next(); word != "endsolid"; word = next(), ++triangles) {
      if (word != "facet")
        refuse(file,
               "expected \"facet\" or \"endsolid\", " +
                   (word.empty() ? "but the file ends" : "found \"" + word.substr(0, 40) + '"'),
               at);
      expect("normal");
      three_numbers(false);
      expect("outer");
      expect("loop");
      for (int i = 0; i < 3; ++i) {
        expect("vertex");
        three_numbers(true);
      }
      expect("endloop");
      expect("endfacet");
    }
    line = {};
  }
  return triangles;
}

/// Checks that an STL file is whole, and counts its triangles.
inline std::size_t check_stl(std::string_view bytes, const std::string& file) {
  const std::string_view start = bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  const bool says_solid = start.starts_with("solid") || start.starts_with("SOLID") || start.starts_with("Solid");
  std::uint64_t count = 0;
  if (bytes.size() >= 84) {
    std::uint32_t stored;
    std::memcpy(&stored, bytes.data() + 80, 4);
    count = stored;
  }
  if (bytes.size() >= 84 && bytes.size() == 84 + 50 * count) return count;  // even where the header says "solid"
  if (says_solid && bytes.find('\0') == bytes.npos) return check_ascii_stl(bytes, file);
  if (bytes.size() < 84) refuse(file, "is shorter than the 84 bytes that begin a binary STL file");
  refuse(file, "as a binary STL file of " + std::to_string(count) + " triangles it would have " +
                   std::to_string(84 + 50 * count) + " bytes, but it has " + std::to_string(bytes.size()));
}

}  // namespace clearance::io
