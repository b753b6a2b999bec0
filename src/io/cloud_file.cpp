// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/cloud_file.hpp>

#include "io/pcd.hpp"
#include "io/ply_values.hpp"

#include <clearance/io/cloud.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/text_file.hpp>

#include <algorithm>
#include <filesystem>

namespace clearance::io {

cloud read_ply(std::string_view rest, const std::string& file) {
  const ply_header header = take_ply_header(rest, file);
  if (!header.elements.empty() && !header.find("vertex")) refuse(file, "a PLY point cloud needs the element vertex");
  std::vector<Eigen::Vector3d> points;
  read_ply_values(
      rest, header, file, [&](const ply_values&, const double* p) { points.emplace_back(p[0], p[1], p[2]); },
      [](const auto&...) {});
  return make_cloud(file, points, points.size(), 1);
}

cloud load_ply(const std::string& file, const read_limits& limits) { return read_ply(read_text(file, limits), file); }

namespace {

/// Are this number's digits grouped in threes, such as 1,234 or 5,000,000.5?
bool in_thousands(std::string_view word) {
  if (word.starts_with('-') || word.starts_with('+')) word.remove_prefix(1);
  for (std::size_t group = 0;; ++group) {
    const std::size_t digits = std::min(word.find_first_not_of("0123456789"), word.size());
    if (group == 0 ? digits < 1 || digits > 3 : digits != 3) return false;
    word.remove_prefix(digits);
    if (!word.starts_with(',')) return group > 0 && (word.empty() || word.starts_with('.'));
    word.remove_prefix(1);
  }
}

/// May a word with commas, beside others in its line, be one number? Not if it is two numbers with a point each.
bool comma_of_one_number(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of(','), word.size()));
  while (word.ends_with(',')) word.remove_suffix(1);
  const std::size_t first = word.find(','), last = word.rfind(',');
  if (first == word.npos) return false;
  if (first < last) return in_thousands(word);
  return word.find('.') > first || word.rfind('.') < first;
}

/// Refuses a line whose x, y and z depend on how commas are read.
void check_xyz_commas(std::string_view line, const std::string& file, std::size_t at) {
  constexpr std::string_view others = " \t\r\v\f;";
  std::size_t numbers = 0;
  for (auto word = take_word(line, others); numbers < 3 && !word.empty(); word = take_word(line, others)) {
    if ((numbers > 0 || line.find_first_not_of(" \t\r\v\f;,") != line.npos) && comma_of_one_number(word))
      refuse(file, quoted(word) + " may be one number or several (decimal commas? write points)", at);
    for (std::string_view rest = word; !take_word(rest, ",").empty();) ++numbers;
  }
}

/// Takes the next value of a line; no value at the line's end. Between commas or semicolons it may be empty.
std::optional<std::string_view> take_field(std::string_view& line) {
  constexpr std::string_view blanks = " \t\r\v\f";
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  if (line.empty()) return std::nullopt;
  const std::string_view field = line.substr(0, line.find_first_of(" \t\r\v\f,;"));
  line.remove_prefix(field.size());
  line.remove_prefix(std::min(line.find_first_not_of(blanks), line.size()));
  if (line.starts_with(',') || line.starts_with(';')) line.remove_prefix(1);
  return field;
}

}  // namespace

cloud load_xyz(const std::string& file, const read_limits& limits) {
  const std::string bytes = read_text(file, limits);
  std::string_view rest = without_mark(bytes);
  std::vector<Eigen::Vector3d> points;
  std::size_t usual = 0;  // words per line

  for (std::size_t at = 1; !rest.empty(); ++at) {
    std::string_view line = take_line(rest);
    line = without_comment(line, " \t\r\v\f,;");
    if (line.starts_with("//") || line.find_first_not_of(" \t\r\v\f,;") == line.npos) continue;
    check_xyz_commas(line, file, at);

    Eigen::Vector3d p;
    for (int axis = 0; axis < 3; ++axis) {
      const auto word = take_field(line);
      if (!word) refuse(file, "a point needs three numbers, here are " + std::to_string(axis), at);
      if (word->empty()) refuse(file, std::string("nothing stands for ") + "xyz"[axis] + " between separators", at);
      const auto value = number<double>(*word);
      if (!value) refuse(file, quoted(*word) + " is not a number", at);
      p[axis] = *value;
    }

    std::size_t count = 3;
    while (take_field(line)) ++count;
    if (points.empty()) usual = count;
    if (count != usual)
      refuse(file, "a point of " + std::to_string(count) + " words, the lines before have " + std::to_string(usual),
             at);
    points.push_back(p);
  }
  return make_cloud(file, points, points.size(), 1);
}

std::string extension(const std::string& file) {
  std::string end = std::filesystem::path(file).extension().string();
  std::transform(end.begin(), end.end(), end.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
  return end;
}

cloud load_cloud(const std::string& file, const read_limits& limits) {
  const std::string end = extension(file);
  if (end == ".pcd") return within_memory(file, [&] { return load_pcd(file, limits); });
  if (end == ".ply") return within_memory(file, [&] { return load_ply(file, limits); });
  if (end == ".xyz" || end == ".txt") return within_memory(file, [&] { return load_xyz(file, limits); });
  refuse(file, std::string("is no point cloud by its name: .pcd, .ply, .xyz and .txt are read") +
                   (end == ".las" || end == ".laz" ? ", LAS and LAZ by the Python package (clearance.recordings.las)"
                                                   : std::string()));
}

}  // namespace clearance::io
