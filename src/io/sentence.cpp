// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/sentence.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace clearance::io {

std::size_t utf8_character(std::string_view text, std::uint32_t& code) {
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

bool is_utf8(std::string_view text) {
  std::uint32_t code = 0;
  while (const std::size_t size = utf8_character(text, code)) text.remove_prefix(size);
  return text.empty();
}

std::string printable(std::string_view text) {
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

std::string shortened(std::string_view text, std::size_t most) {
  if (text.size() <= most) return std::string(text);
  const auto continues = [&](std::size_t at) { return std::uint8_t(text[at]) >> 6 == 2; };
  std::size_t head = (most - 3) / 2, tail = text.size() - (most - 3 - head);
  while (head > 0 && continues(head)) --head;
  while (tail < text.size() && continues(tail)) ++tail;
  return std::string(text.substr(0, head)) + "..." + std::string(text.substr(tail));
}

std::string sentence(std::string_view text, std::size_t most) {
  if (text.size() > 4 * longest_sentence)
    return shortened(
        printable(text.substr(0, longest_sentence)) + "..." + printable(text.substr(text.size() - longest_sentence)),
        most);
  return shortened(printable(text), most);
}

std::string sentence_about(std::string_view place, std::string_view why) {
  const std::string where = sentence(place, 220) + ": ";
  return where + sentence(why, longest_sentence - 20 - where.size());
}

std::string quoted(std::string_view word) { return '"' + sentence(word, 60) + '"'; }

}  // namespace clearance::io
