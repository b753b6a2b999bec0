// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"
#include "io/png_check.hpp"

#include <clearance/io/png.hpp>

namespace png_target {

namespace {

using namespace clearance;

std::string big_endian(std::uint32_t value) {
  std::string made;
  for (int shift = 24; shift >= 0; shift -= 8) made += char(value >> shift);
  return made;
}

/// Makes the checksums of chunks and pixels right again.
fuzz::bytes damage_png(fuzz::bytes input, std::mt19937&) {
  std::string made = fuzz::any_damage(input), packed;
  std::size_t last = 0;  // the last chunk of data
  for (const bool sums : {false, true}) {
    for (std::size_t at = 8; at + 12 <= made.size();) {
      const std::size_t size = io::png_number(std::string_view(made).substr(at));
      if (size > made.size() - at - 12) break;
      const std::string_view chunk = std::string_view(made).substr(at + 4, size + 4);
      if (sums)
        made.replace(at + 8 + size, 4, big_endian(io::png_crc(chunk)));
      else if (chunk.starts_with("IDAT") && size >= 4)
        packed += chunk.substr(4), last = at;
      at += size + 12;
    }
    if (sums || last == 0) continue;
    std::string raw(1 << 16, '\0');
    const int count = io::png_unpack(packed, raw);
    if (count < 0) continue;
    const std::size_t end = last + 8 + io::png_number(std::string_view(made).substr(last));
    made.replace(end - 4, 4, big_endian(io::adler32(std::string_view(raw).substr(0, std::size_t(count)))));
  }
  return made;
}

void read(std::string_view input) {
  fuzz::put("m.png", input);
  io::depth_frame frame;
  if (!fuzz::reads("m.png", [&] { frame = io::load_png("m.png", fuzz::limits); })) return;
  if (frame.pixels.size() != frame.width * frame.height)
    fuzz::finding("width times height is not the number of pixels");
  if (frame.pixels != io::load_png("m.png", fuzz::limits).pixels) fuzz::finding("the same file twice, two images");
}

const fuzz::target png("png", read, damage_png);

}  // namespace

}  // namespace png_target
