// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The .ist file: packings with all that is known about them. Bytes: docs/packing.md#the-ist-format-version-1.

#include <clearance/io/packed_part.hpp>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

inline constexpr std::string_view ist_magic = "\x89IST\r\n\x1a\n";  // a transfer as text would damage it

inline constexpr std::uint32_t ist_version = 1;

/// Calls `visit` with every member of a packing, in the file's order. If a packing gains a member, this does not
/// compile: write the new member to the file as well, and raise ist_version.
namespace detail {

template <class Packing, class Visit>
void for_each_member(Packing& p, Visit visit) {
  auto& [spheres, gap, tolerance, gap_mean, gap_p95, fill, radius_min, radius_max, room, stopped_by, seconds] = p;
  static_cast<void>(tolerance);  // is written with the part
  visit(gap);
  visit(gap_mean);
  visit(gap_p95);
  visit(fill);
  visit(radius_min);
  visit(radius_max);
  visit(room);
  visit(seconds);
  visit(stopped_by);
  visit(spheres);
}

}  // namespace detail

std::string ist_bytes(std::span<const packed_part> parts);

/// Parses what `ist_bytes` made; error sentences name `file`.
std::vector<packed_part> read_ist(std::string_view bytes, const std::string& file);

/// Loads what save_ist wrote, to the bit. Throws std::runtime_error with a sentence for anything else.
std::vector<packed_part> load_ist(const std::string& file);

/// Saves packings with their certificates. Throws std::invalid_argument for what load_ist would refuse.
void save_ist(std::span<const packed_part> parts, const std::string& file);

}  // namespace clearance::io
