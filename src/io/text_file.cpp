// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/text_file.hpp>

#include <clearance/io/error.hpp>

#include <cstdint>
#include <string>
#include <string_view>

namespace clearance::io {

namespace {

void append_utf8(std::string& to, std::uint32_t code) {
  if (code < 0x80) {
    to += char(code);
    return;
  }
  const int more = code < 0x800 ? 1 : code < 0x10000 ? 2 : 3;  // bytes that follow the first
  constexpr std::uint32_t first[] = {0, 0xC0, 0xE0, 0xF0};
  to += char(first[more] | code >> 6 * more);
  for (int k = more - 1; k >= 0; --k) to += char(0x80 | ((code >> 6 * k) & 0x3F));
}

/// What UTF-16 after its mark says.
std::string from_utf16(std::string_view bytes, bool highest_first, const std::string& file) {
  if (bytes.size() % 2 != 0) refuse(file, "is text in UTF-16, and ends within a character");
  const auto unit = [&](std::size_t i) {
    const auto a = std::uint32_t(std::uint8_t(bytes[i])), b = std::uint32_t(std::uint8_t(bytes[i + 1]));
    return highest_first ? a << 8 | b : b << 8 | a;
  };
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    const bool pair = code >= 0xD800 && code < 0xDC00 && i + 2 < bytes.size();
    const std::uint32_t low = pair ? unit(i + 2) : 0;
    if (low >= 0xDC00 && low < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
      i += 2;
    } else if (code >= 0xD800 && code < 0xE000) {
      refuse(file, "is text in UTF-16, and half a character stands at byte " + std::to_string(i + 2));
    }
    append_utf8(text, code);
  }
  return text;
}

}  // namespace

std::string as_utf8(std::string bytes, const std::string& file) {
  const std::string_view all = bytes, begin = all.substr(0, 4);
  if (begin == std::string_view("\xFF\xFE\0\0", 4) || begin == std::string_view("\0\0\xFE\xFF", 4))
    refuse(file, "is text in UTF-32, which is not read: save it as UTF-8");
  if (begin.starts_with("\xFF\xFE")) return from_utf16(all.substr(2), false, file);
  if (begin.starts_with("\xFE\xFF")) return from_utf16(all.substr(2), true, file);
  const auto zero = [&](std::size_t i) { return begin[i] == '\0'; };
  if (begin.size() == 4 && zero(0) == zero(2) && zero(1) == zero(3) && zero(0) != zero(1))
    refuse(file, "is text in UTF-16 without a byte order mark, which is not read: save it as UTF-8");
  return bytes;
}

std::string read_text(const std::string& file, const read_limits& limits) {
  return as_utf8(read_bytes(file, limits), file);
}

}  // namespace clearance::io
