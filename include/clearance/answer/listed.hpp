// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::pairwise {

/// An answer: a list of pairs in the order in which they are found.
struct listed {
  pair_distance* pairs;
  unsigned long long* count;  ///< Counts all pairs; those beyond `capacity` are not kept.
  unsigned long long capacity;
  const real* reaches;  ///< One per part.

  CLEARANCE_HD real reach(std::uint32_t part) const { return reaches[part]; }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    if (const unsigned long long i = take_number(count); i < capacity) pairs[i] = pair;
  }
};
static_assert(answer<listed>);

}  // namespace clearance::pairwise
