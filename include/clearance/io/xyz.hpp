// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/cloud.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

namespace clearance::io {

/// Reads a text file with a point on each line: x y z in metres, then anything, in as many words on every line: two
/// lines that became one are refused. Blanks, tabs, commas and semicolons separate; a word that starts with # starts a
/// comment; "nan" keeps a record's place. Throws std::runtime_error naming file and line.
inline cloud load_xyz(const std::string& file, const read_limits& limits = {}) {
  constexpr std::string_view separators = " \t\r\v\f,;";
  const std::string bytes = read_bytes(file, limits);
  std::string_view rest = without_mark(bytes);
  std::vector<Eigen::Vector3d> points;
  std::size_t usual = 0;  // words of a line
  for (std::size_t at = 1; !rest.empty(); ++at) {
    std::string_view line = take_line(rest);
    line = without_comment(line, separators);
    std::string_view word = take_word(line, separators);
    if (word.empty()) continue;
    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; word = take_word(line, separators), ++axis) {
      if (word.empty()) refuse(file, "a point needs three numbers, here are " + std::to_string(axis), at);
      const auto value = number<double>(word);
      if (!value) refuse(file, quoted(word) + " is not a number", at);
      p[axis] = *value;
    }
    std::size_t count = 3;
    for (; !word.empty(); word = take_word(line, separators)) ++count;
    if (points.empty()) usual = count;
    if (count != usual)
      refuse(file, "a point of " + std::to_string(count) + " words, the lines before have " + std::to_string(usual),
             at);
    points.push_back(p);
  }
  return make_cloud(file, points, points.size(), 1);
}

}  // namespace clearance::io
