// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/sentence.hpp>

#include <cstdarg>
#include <cstdio>
#include <string>

/// printf's text, at most 1023 bytes.
[[gnu::format(printf, 1, 2)]] inline std::string text(const char* format, ...) {
  char line[1024];
  va_list values;
  va_start(values, format);
  std::vsnprintf(line, sizeof line, format, values);
  va_end(values);
  return line;
}

/// A name, and spaces up to the column where a list goes on; no name, for a further line of the same.
inline std::string name_column(const std::string& name) {
  const std::string shown = clearance::io::printable(name);
  return "  " + shown + std::string(shown.size() < 28 ? 28 - shown.size() : 1, ' ');
}
