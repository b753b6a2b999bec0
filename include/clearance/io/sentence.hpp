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
inline std::size_t utf8_character(std::string_view text, std::uint32_t& code) {
  const auto byte = [&](std::size_t i) { return std::uint32_t(std::uint8_t(text[i])); };
  if (text.empty()) return 0;
  const std::uint32_t first = byte(0);
  const std::size_t size = first < 0x80 ? 1 : first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
  if (size == 0 || size > text.size()) return 0;
  code = size == 1 ? first : first & (0x7Fu >> size);
  for (std::size_t i = 1; i < size; ++i) {
    if (byte(i) >> 6 != 2) return 0;
    code = code << 6 | (byte(i) & 63u);
  }
  constexpr std::uint32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  return code < least[size] || code > 0x10FFFF || (code >= 0xD800 && code < 0xE000) ? 0 : size;
}

inline bool is_utf8(std::string_view text) {
  std::uint32_t code = 0;
  while (const std::size_t size = utf8_character(text, code)) text.remove_prefix(size);
  return text.empty();
}

/// Does this character control a terminal, end a line, or change the direction of writing?
constexpr bool controls(std::uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0) || code == 0x61C || code == 0x200E || code == 0x200F ||
         (code >= 0x2028 && code <= 0x202E) || (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
}

/// Valid UTF-8 on one line. Invalid bytes and control characters become \xNN, byte by byte.
inline std::string printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    std::uint32_t code = 0;
    const std::size_t size = utf8_character(text, code);
    if (size > 0 && !controls(code)) {
      out += text.substr(0, size);
      text.remove_prefix(size);
      continue;
    }
    for (std::size_t rest = size > 0 ? size : 1; rest > 0; --rest, text.remove_prefix(1)) {
      const auto byte = std::uint8_t(text[0]);
      (out += "\\x") += "0123456789abcdef"[byte >> 4];
      out += "0123456789abcdef"[byte & 15];
    }
  }
  return out;
}

/// At most `most` bytes (at least 8) of UTF-8. A longer text keeps its beginning and end, with "..." between them.
inline std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  const auto continues = [&](std::size_t at) { return std::uint8_t(text[at]) >> 6 == 2; };
  std::size_t head = (most - 3) / 2, tail = text.size() - (most - 3 - head);
  while (head > 0 && continues(head)) --head;
  while (tail < text.size() && continues(tail)) ++tail;
  return std::string(text.substr(0, head)) + "..." + std::string(text.substr(tail));
}

/// The most bytes that a message may have.
inline constexpr std::size_t longest_sentence = 400;

/// A message ready to show: printable, at most `most` bytes. Only the ends of a long text are looked at.
inline std::string sentence(std::string_view text, std::size_t most = longest_sentence) {
  if (text.size() > 4 * longest_sentence)
    return shortened(
        printable(text.substr(0, longest_sentence)) + "..." + printable(text.substr(text.size() - longest_sentence)),
        most);
  return shortened(printable(text), most);
}

/// "place: why" as one sentence, short enough for a word before it. Neither half can push out the other.
inline std::string sentence_about(std::string_view place, std::string_view why) {
  const std::string where = sentence(place, 220) + ": ";
  return where + sentence(why, longest_sentence - 20 - where.size());
}

/// The beginning of a word or name, quoted for a sentence.
inline std::string quoted(std::string_view word) { return '"' + sentence(word, 60) + '"'; }

}  // namespace clearance::io
