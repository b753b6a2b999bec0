// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

#include <clearance/io/bytes.hpp>
#include "io/png_check.hpp"

namespace ist_target {

namespace {

/// Most damage would only be a false length or checksum.
fuzz::bytes damage_ist(fuzz::bytes input, std::mt19937&) {
  std::string made = fuzz::any_damage(input);
  if (made.size() < 28) return made;
  clearance::io::byte_writer size, sum;
  size.put(std::uint64_t(made.size()));
  made.replace(16, 8, size.bytes());
  sum.put(clearance::io::png_crc(std::string_view(made).substr(0, made.size() - 4)));
  return made.replace(made.size() - 4, 4, sum.bytes());
}

const fuzz::target ist("ist", [](std::string_view input) { fuzz::read_spheres("m.ist", input); }, damage_ist);

}  // namespace

}  // namespace ist_target
