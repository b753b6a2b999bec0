// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/laws.hpp"

#include <clearance/result.hpp>

#include <algorithm>

namespace testing {

/// Compares everything in a result, numbers by their bits.
inline bool same_result(const clearance::min_distance_result& a, const clearance::min_distance_result& b) {
  return a.state == b.state && same_bits(a.distance, b.distance) && same_bits(a.lower, b.lower) &&
         same_bits(a.upper, b.upper) && a.cloud == b.cloud && a.point == b.point && a.part == b.part &&
         a.primitive == b.primitive && same_bytes(a.at, b.at) && same_bytes(a.nearest, b.nearest) &&
         same_bytes(a.normal, b.normal) && a.seen == b.seen && a.valid == b.valid &&
         std::equal(a.dropped, a.dropped + clearance::drop_reasons, b.dropped);
}

/// Compares everything in a part's minimum.
inline bool same_minimum(const clearance::part_minimum& a, const clearance::part_minimum& b) {
  return same_bits(a.distance, b.distance) && a.cloud == b.cloud && a.point == b.point && a.primitive == b.primitive;
}

/// Compares everything in a part's witness.
inline bool same_witness(const clearance::part_witness& a, const clearance::part_witness& b) {
  return a.part == b.part && a.cloud == b.cloud && a.point == b.point && a.primitive == b.primitive &&
         same_bits(a.distance, b.distance) && same_bytes(a.at, b.at) && same_bytes(a.nearest, b.nearest) &&
         same_bytes(a.normal, b.normal);
}

}  // namespace testing
