// SPDX-License-Identifier: BSD-3-Clause
// The mesh readers are our own: assimp 5.2 loses triangle order among materials, refuses ".8e-1", reads "1.#IND" as 1,
// drops what it does not understand, and hangs or crashes on damaged files. Ours also keep doubles.

#include "io/mesh_formats.hpp"
#include "io/mesh_polygons.hpp"

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace clearance::io {

Eigen::Vector3d take_vertex(std::string_view& line, const std::string& file, std::size_t at) {
  Eigen::Vector3d v;
  for (double& x : v) {
    const std::string_view word = take_word(line);
    const auto value = number<double>(word);
    if (word.empty()) refuse(file, "a vertex has fewer than three coordinates", at);
    if (!value) refuse(file, "\"" + std::string(word.substr(0, 40)) + "\" is not a number", at);
    if (!std::isfinite(*value)) refuse(file, "a vertex has a coordinate that is not finite", at);
    x = *value;
  }
  return v;
}

std::size_t numbers_left(std::string_view line, const std::string& file, std::size_t at) {
  std::size_t count = 0;
  for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line)) {
    ++count;
    const std::size_t comment = word.find('#');  // as in a colour "0.5#red"; in "1.#IND" it is no comment
    const bool ends = comment != word.npos && std::isdigit(static_cast<unsigned char>(word[comment - 1]));
    if (!number<double>(ends ? word.substr(0, comment) : word)) refuse(file, quoted(word) + " is not a number", at);
    if (ends) break;
  }
  return count;
}

namespace {

/// Does this word begin an OBJ statement? Includes skin weights, which some tools add to the format.
bool obj_statement(std::string_view word) {
  for (const std::string_view known :
       {"v",          "vt",        "vn",     "vp",     "vw",     "f",      "l",     "p",     "g",        "o",
        "s",          "usemtl",    "mtllib", "usemap", "maplib", "mg",     "bevel", "lod",   "c_interp", "d_interp",
        "shadow_obj", "trace_obj", "cstype", "deg",    "bmat",   "step",   "curv",  "curv2", "surf",     "parm",
        "trim",       "hole",      "scrv",   "sp",     "end",    "con",    "ctech", "stech", "call",     "csh",
        "bsp",        "bzp",       "cdc",    "cdp",    "res",    "maxsize"})
    if (word == known) return true;
  return false;
}

/// The vertex of a face's corner "1", "1/2", "1//3" or "1/2/3"; nothing if the word is none of these.
std::optional<std::int64_t> obj_corner(std::string_view word) {
  std::optional<std::int64_t> vertex;
  for (int k = 0; k < 3; ++k) {  // texture and normal are skipped
    const std::size_t end = std::min(word.find('/'), word.size());
    const std::string_view one = word.substr(0, end);
    const auto value = number<std::int64_t>(one);
    if (k == 0) vertex = value;
    if (!value && (k == 0 || !one.empty())) return std::nullopt;
    if (end == word.size()) return vertex;
    word.remove_prefix(end + 1);
  }
  return std::nullopt;
}

/// A statement that is skipped and holds no name. If another begins in its line, a line end was lost.
bool obj_of_numbers(std::string_view key) {
  return key == "vn" || key == "vt" || key == "vp" || key == "s" || key == "l" || key == "p";
}

/// A statement of names or paths, which may end in a backslash.
bool obj_of_names(std::string_view key) {
  for (const std::string_view known : {"g", "o", "usemtl", "mtllib", "usemap", "maplib", "shadow_obj", "trace_obj"})
    if (key == known) return true;
  return false;
}

/// A statement with geometry that this reader would skip: free-form curves and surfaces, and other files.
bool obj_of_more(std::string_view key) {
  for (const std::string_view known : {"surf", "curv", "curv2", "bsp", "bzp", "cdc", "cdp", "call", "csh"})
    if (key == known) return true;
  return false;
}

/// Takes the next statement off `rest`: a line, and lines that a backslash at the end joins to it (into `joined`). A
/// backslash joins nothing in a comment; after a name, only a line that begins no statement. `at` counts lines.
std::string_view take_obj_statement(std::string_view& rest, std::string& joined, std::size_t& at) {
  std::string_view line = take_line(rest), start = line;
  ++at;
  const bool names = obj_of_names(take_word(start));
  const auto goes_on = [&](std::string_view end) {
    if (!end.ends_with('\\') || rest.empty() || without_comment(end).size() < end.size()) return false;
    std::string_view next = rest;
    next = take_line(next);
    const std::string_view first = take_word(next);
    return !names || !(first.empty() || first.front() == '#' || obj_statement(first));
  };
  if (!goes_on(line)) return line;
  joined.clear();
  for (; goes_on(line); ++at, line = take_line(rest)) joined.append(line.substr(0, line.size() - 1)).push_back(' ');
  return joined.append(line);
}

/// Collects the contents of an OBJ file.
class obj_reader {
 public:
  explicit obj_reader(const std::string& file) : file_(file) {}

  /// A statement that begins in line `at`. If `last`, nothing follows it, not even a line end.
  void read_line(std::string_view line, std::size_t at, bool last) {
    const std::string_view key = take_word(line);
    if (key == "v") {
      made_.vertices.push_back(take_vertex(line, file_, at));
      const std::size_t more = numbers_left(line, file_, at);  // a weight, a colour, or both
      if (more != 0 && more != 1 && more != 3 && more != 4)
        refuse(file_, "a vertex of " + std::to_string(3 + more) + " numbers", at);
    } else if (key == "f") {
      take_face(line, at, last);
    } else if (obj_of_numbers(key)) {
      for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line))
        if (obj_statement(word)) refuse(file_, quoted(word) + " begins a second statement in the line", at);
    } else if (obj_of_more(key)) {
      refuse(file_, quoted(key) + " brings geometry that is not supported: polygons alone are read", at);
    } else if (!key.empty() && key.front() != '#' && !obj_statement(key)) {
      // Some files begin with their counts.
      const bool counts = made_.vertices.empty() && number<std::uint64_t>(key) && numbers_left(line, file_, at) < 2;
      if (!counts) refuse(file_, quoted(key) + " begins no statement of an OBJ file", at);
    }
  }

  polygon_mesh finish() {
    if (largest_ > made_.vertices.size())
      refuse(
          file_,
          "a face has vertex " + std::to_string(largest_) + ", the file has " + std::to_string(made_.vertices.size()),
          largest_at_);
    if (short_at_ != 0 && !any_)
      refuse(file_, "a face has fewer than three vertices, and so has every other", short_at_);
    return std::move(made_);
  }

 private:
  void take_face(std::string_view line, std::size_t at, bool last) {
    const std::size_t begin = made_.corners.size();
    for (auto word = take_word(line); !word.empty() && word.front() != '#'; word = take_word(line)) {
      const auto given = obj_corner(word);
      const std::int64_t count = std::int64_t(made_.vertices.size());
      const std::int64_t index = !given       ? 0
                                 : *given < 0 ? *given + count + 1
                                              : *given;  // from 1; negative: from the end
      if (index < 1 || index > std::int64_t(UINT32_MAX)) refuse(file_, quoted(word) + " is no vertex of a face", at);
      if (index > largest_) {
        largest_ = std::uint32_t(index);
        largest_at_ = at;
      }
      made_.corners.push_back(std::uint32_t(index - 1));
    }
    const std::size_t corners = made_.corners.size() - begin;
    if (corners == 0 || (corners < 3 && last)) refuse(file_, "a face has fewer than three vertices", at);
    any_ = any_ || corners > 2;
    if (corners < 3) short_at_ = at;
    // Modellers write an edge as a face of two corners; as a triangle without area it means the same.
    made_.corners.resize(begin + std::max<std::size_t>(corners, 3), made_.corners.back());
    made_.ends.push_back(made_.corners.size());
  }

  const std::string& file_;
  polygon_mesh made_;
  std::uint32_t largest_ = 0;
  std::size_t largest_at_ = 0, short_at_ = 0;  // lines
  bool any_ = false;                           // a face of three corners or more
};

}  // namespace

polygon_mesh read_obj(std::string_view rest, const std::string& file) {
  if (rest.find('\0') != rest.npos) refuse(file, "is not an OBJ file: it has zero bytes, so it is not plain text");
  obj_reader reader(file);
  std::string joined;
  for (std::size_t lines = 0; !rest.empty();) {
    const std::size_t first = lines + 1;
    const std::string_view all = rest, statement = take_obj_statement(rest, joined, lines);
    reader.read_line(statement, first, rest.empty() && !all.ends_with('\n') && !all.ends_with('\r'));
  }
  return reader.finish();
}

}  // namespace clearance::io
