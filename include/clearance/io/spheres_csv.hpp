// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/write_file.hpp>

#include <span>

namespace clearance::io {

/// Reads spheres from a text file: an optional header x,y,z,r, then four numbers per line, metres; # begins a comment.
/// They keep the file's order and have no certificate. Throws std::runtime_error naming file and line.
inline packing load_spheres_csv(const std::string& file) {
  constexpr std::string_view separators = " \t\r\v\f,;";
  const std::string bytes = read_bytes(file);
  std::string_view rest = without_mark(bytes);
  std::vector<inner_sphere> spheres;
  bool header_may_come = true;
  for (std::size_t at = 1; !rest.empty(); ++at) {
    std::string_view line = take_line(rest);
    line = without_comment(line, separators);
    std::vector<std::string_view> fields;
    for (auto word = take_word(line, separators); !word.empty(); word = take_word(line, separators))
      fields.push_back(word);
    if (fields.empty()) continue;
    const bool header = header_may_come && !number<double>(fields[0]);
    header_may_come = false;
    if (header) {
      if (fields.size() != 4 || fields[0] != "x" || fields[1] != "y" || fields[2] != "z" ||
          (fields[3] != "r" && fields[3] != "radius"))
        refuse(file, "the header is not x,y,z,r", at);
      continue;
    }
    if (fields.size() != 4)
      refuse(file, "a sphere needs four numbers, x,y,z,r; here are " + std::to_string(fields.size()), at);
    float n[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto value = number<float>(fields[k]);
      if (!value) refuse(file, io::quoted(fields[k]) + " is not a number", at);
      n[k] = *value;
    }
    spheres.push_back(checked_sphere({n[0], n[1], n[2]}, n[3], file, "the sphere", at));
  }
  if (spheres.empty()) refuse(file, "has no sphere");
  return uncertified(std::move(spheres));
}

/// Saves x,y,z,r with every float exact; the certificate is lost.
inline void save_spheres_csv(std::span<const inner_sphere> spheres, const std::string& file) {
  std::string text = "x,y,z,r\n";
  for (const inner_sphere& s : spheres)
    text += shortest(s.center.x) + ',' + shortest(s.center.y) + ',' + shortest(s.center.z) + ',' + shortest(s.radius) +
            '\n';
  write_bytes(file, text);
}

}  // namespace clearance::io
