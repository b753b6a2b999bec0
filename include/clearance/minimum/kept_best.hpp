// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a device keeps about a minimum, within a frame and for the next one.

#include <clearance/result.hpp>
#include <clearance/scan/arguments.hpp>
#include <clearance/scan/record.hpp>

namespace clearance::minimum {

using scan::no_bound;

using scan::record, scan::before, scan::same;

/// A minimum of the last frame, which gives this frame's first bound.
template <class Record, class Primitive>
struct witness {
  Record r;
  Primitive primitive;
};

/// Lives in device memory from frame to frame. The last block of a frame resets all but the number of witnesses. If all
/// parts share a bound, it is in slot 0; otherwise each part has its own slot.
template <class Record>
struct device_state {
  std::uint32_t bound[scan::most_parts];  ///< ordered() upper bounds of this frame, shared by all blocks.
  Record best[scan::most_parts];          ///< Minima over the finished clouds,
  distance_key best_key = no_key;         ///< and over the finished blocks, if all parts share a bound.
  std::uint32_t witnesses = 0;
  std::uint32_t seeded = 0;  ///< Blocks that have seeded (cold frames only).
  unsigned long long certain = 0;

  device_state() {
    for (auto& b : bound) b = no_bound;
  }
};

/// The answer without the counts, if a block's best is the best of all.
struct draft {
  position at, nearest;
  vec3 normal;
  std::uint32_t primitive, part;
  clearance::state state;
  real distance, lower, upper;
};

}  // namespace clearance::minimum
