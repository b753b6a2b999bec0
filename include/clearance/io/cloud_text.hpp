// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Lines, words and numbers of a text file, without locale and without copies.

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace clearance::io {

/// Takes the next line off `rest`, without its end (\n or \r\n).
inline std::string_view take_line(std::string_view& rest) {
  const std::size_t end = rest.find('\n');
  std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

/// Takes the next word off `line`; empty at its end. Any of `separators` ends a word.
inline std::string_view take_word(std::string_view& line, std::string_view separators = " \t\r\v\f") {
  line.remove_prefix(std::min(line.find_first_not_of(separators), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(separators));
  line.remove_prefix(word.size());
  return word;
}

inline std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> all;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) all.push_back(word);
  return all;
}

/// The number that the whole word spells ("nan" and "inf" too; beyond double it is inf or 0), or nothing.
template <class T>
std::optional<T> number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    if constexpr (std::numeric_limits<T>::is_integer)
      return std::nullopt;
    else
      return word.find("e-") == word.npos && word.find("E-") == word.npos ? std::numeric_limits<T>::infinity() : T(0);
  }
  return error == std::errc{} ? std::optional<T>(value) : std::nullopt;
}

/// The beginning of a word as a sentence may show it: no control characters, no bytes beyond ASCII.
inline std::string quoted(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return '"' + text + '"';
}

}  // namespace clearance::io
