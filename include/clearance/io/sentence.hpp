// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Makes text safe for messages, whatever names and words a file contains.

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace clearance::io {

/// Bytes of the first UTF-8 character of `text`, and its number in `code`; 0 if there is none (cut short, overlong, a
/// surrogate).
std::size_t utf8_character(std::string_view text, std::uint32_t& code);

bool is_utf8(std::string_view text);

/// Does this character control a terminal, end a line, or change the direction of writing?
constexpr bool controls(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x61C || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
}

/// Valid UTF-8 on one line. Invalid bytes and control characters become \xNN, byte by byte.
std::string printable(std::string_view text);

/// At most `most` bytes (at least 8) of UTF-8. A longer text keeps its beginning and end, with "..." between them.
std::string shortened(std::string_view text, std::size_t most);

/// The most bytes that a message may have.
inline constexpr std::size_t longest_sentence = 400;

/// A message ready to show: printable, at most `most` bytes. Only the ends of a long text are looked at.
std::string sentence(std::string_view text, std::size_t most = longest_sentence);

/// "place: why" as one sentence, short enough for a word before it. Neither half can push out the other.
std::string sentence_about(std::string_view place, std::string_view why);

/// The beginning of a word or name, quoted for a sentence.
std::string quoted(std::string_view word);

}  // namespace clearance::io
