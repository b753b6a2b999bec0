// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

#include <clearance/io/bytes.hpp>

namespace glb_target {

namespace {

void put_word(std::string& made, std::size_t at, std::size_t value) {
  clearance::io::byte_writer word;
  word.put(std::uint32_t(value));
  made.replace(at, 4, word.bytes());
}

/// Makes the lengths of file and chunks right again.
fuzz::bytes damage_glb(fuzz::bytes input, std::mt19937&) {
  std::string made = fuzz::any_damage(input);
  const std::size_t data = made.find(std::string_view("BIN\0", 4));
  if (made.size() < 24 || data < 24 || data == made.npos) return made;
  put_word(made, 8, made.size());
  put_word(made, 12, data - 24);
  put_word(made, data - 4, made.size() - data - 4);
  return made;
}

const fuzz::target glb("glb", [](std::string_view input) { fuzz::read_mesh("m.glb", input); }, damage_glb);

}  // namespace

}  // namespace glb_target
