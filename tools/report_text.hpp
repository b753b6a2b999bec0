// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/sentence.hpp>

#include <cctype>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <string>

/// Text whose numbers are readable: what has more than 17 digits before its point gets an exponent, and a zero, if
/// `no_signs`, loses its sign.
inline std::string with_short_numbers(const std::string& line, bool no_signs) {
  const auto digit = [&](std::size_t at) { return at < line.size() && line[at] >= '0' && line[at] <= '9'; };
  const auto of_word = [&](std::size_t at) {
    return at < line.size() &&
           (std::isalnum(static_cast<unsigned char>(line[at])) || line[at] == '.' || line[at] == '_');
  };
  std::string out;
  for (std::size_t at = 0; at < line.size();) {
    const bool negative = line[at] == '-';
    std::size_t end = at + negative;
    if (!digit(end) || (at > 0 && of_word(at - 1))) {
      out += line[at++];
      continue;
    }

    const std::size_t whole = end;
    while (digit(end)) ++end;
    const std::size_t point = end;
    if (end < line.size() && line[end] == '.' && digit(end + 1))
      for (++end; digit(end);) ++end;

    std::string number = line.substr(at, end - at);
    if (const bool complete = !of_word(end) || (line[end] == '.' && !of_word(end + 1)); complete) {
      if (number.find_first_not_of("-0.") == number.npos && no_signs && point < end) number.erase(0, negative);
      if (point - whole > 17 && point < end) {
        char shorter[32];
        std::snprintf(shorter, sizeof shorter, "%.9g", std::strtod(number.c_str(), nullptr));
        number = shorter;
      }
    }
    out += number;
    at = end;
  }
  return out;
}

/// printf's text, at most 1023 bytes, with short numbers.
[[gnu::format(printf, 1, 2)]] inline std::string text(const char* format, ...) {
  char line[1024];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return with_short_numbers(line, true);
}

/// A name, and spaces up to the column where a list goes on; no name, for a further line of the same.
inline std::string name_column(const std::string& name) {
  const std::string shown = clearance::io::printable(name);
  return "  " + shown + std::string(shown.size() < 28 ? 28 - shown.size() : 1, ' ');
}
