// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Everything that the command tells people besides its answers: lines of at most 400 bytes, harmless on a terminal.

#include "report_text.hpp"

#include <clearance/io/sentence.hpp>

#include <cstdio>
#include <string>
#include <vector>

/// Prints "word: text" on stderr.
inline void say(const std::string& word, const std::string& text) {
  const std::string line =
      word + ": " +
      clearance::io::sentence(with_short_numbers(text, false), clearance::io::longest_sentence - word.size() - 2) +
      '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

inline void say_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) say("note", note);
}
