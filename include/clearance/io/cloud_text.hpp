// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Lines, words and numbers of a text file, without a locale and without copies.

#include <clearance/io/sentence.hpp>

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

/// Takes the next line off `rest`, without its line end: \n, \r\n or \r alone.
inline std::string_view take_line(std::string_view& rest) {
  std::size_t end = 0;
  while (end < rest.size() && rest[end] != '\n' && rest[end] != '\r') ++end;
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(std::min(rest.size(), end + (rest.substr(end).starts_with("\r\n") ? 2 : 1)));
  return line;
}

/// The binary data after a text header. The header's last line was just taken off `all`, which left `rest`. If the
/// header's lines end with \r alone, a \n after the last one belongs to the data.
inline std::string_view data_after(std::string_view all, std::string_view rest) {
  const std::string_view first = all.substr(std::min(all.find_first_of("\r\n"), all.size()));
  const std::size_t taken = all.size() - rest.size();
  const bool returns = first.starts_with('\r') && !first.starts_with("\r\n");
  return returns && all.substr(0, taken).ends_with("\r\n") ? all.substr(taken - 1) : rest;
}

/// Drops the byte order mark that some editors put first.
inline std::string_view without_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes;
}

/// Takes the next word off `line`; empty at the line's end. Any of `separators` ends a word.
inline std::string_view take_word(std::string_view& line, std::string_view separators = " \t\r\v\f") {
  line.remove_prefix(std::min(line.find_first_not_of(separators), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(separators));
  line.remove_prefix(word.size());
  return word;
}

/// The line without its comment. A # at the start of a word begins one: "1.#QNAN" has none, and is no number.
inline std::string_view without_comment(std::string_view line, std::string_view separators = " \t\r\v\f") {
  for (std::size_t at = line.find('#'); at != line.npos; at = line.find('#', at + 1))
    if (at == 0 || separators.find(line[at - 1]) != separators.npos) return line.substr(0, at);
  return line;
}

inline std::vector<std::string_view> words(std::string_view line) {
  std::vector<std::string_view> all;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) all.push_back(word);
  return all;
}

/// `word` spells a number that no double holds: is it too small (and not too large)?
inline bool spells_tiny(std::string_view word) {
  const std::size_t e = std::min(word.find_first_of("eE"), word.size());
  const std::size_t point = std::min(word.find('.'), e), first = word.find_first_of("123456789");
  long long exponent = 0;
  if (e < word.size()) {
    std::string_view spelt = word.substr(e + 1);
    if (spelt.starts_with('+')) spelt.remove_prefix(1);
    const auto [end, error] = std::from_chars(spelt.data(), spelt.data() + spelt.size(), exponent);
    if (error == std::errc::result_out_of_range) return spelt.starts_with('-');
  }
  return first > point ? exponent < (long long)(first - point) : exponent + (long long)(point - first) < 0;
}

/// The number that the whole word spells ("nan" and "inf" too). A number too small for its type is 0; one too large,
/// and anything else, is nothing.
template <class T>
std::optional<T> number(std::string_view word) {
  if (word.size() > 1 && word.front() == '+' && word[1] != '-') word.remove_prefix(1);  // from_chars knows no plus
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if constexpr (!std::numeric_limits<T>::is_integer)
    if (error == std::errc::result_out_of_range && spells_tiny(word)) return T(0);
  return error == std::errc{} ? std::optional<T>(value) : std::nullopt;
}

}  // namespace clearance::io
