// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// All that the command says to people, beside its answers: one line of at most 400 bytes, harmless on a terminal.

#include <clearance/io/sentence.hpp>

#include <cstdio>
#include <string>
#include <vector>

/// On stderr, as "word: text".
inline void say(const std::string& word, const std::string& text) {
  const std::string line =
      word + ": " + clearance::io::sentence(text, clearance::io::longest_sentence - word.size() - 2) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

inline void say_notes(const std::vector<std::string>& notes) {
  for (const auto& note : notes) say("note", note);
}
