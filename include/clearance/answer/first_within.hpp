// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::pairwise {

/// An answer: the first pair within margins, certain pairs before uncertain ones. Pairs after a certain one are not
/// looked at.
struct first_within {
  unsigned long long* word;  ///< One bit: not certain; then the point's number through all clouds; then the part.
  const real *may_be, *is;   ///< One of each per part.
  const std::uint32_t* first_point;  ///< Per cloud.

  static constexpr unsigned long long nothing = ~0ull, uncertain = 1ull << 63;

  CLEARANCE_HD unsigned long long key(std::uint32_t cloud, std::uint32_t point, std::uint32_t part) const {
    return (static_cast<unsigned long long>(first_point[cloud]) + point) << 31 | part;
  }
  CLEARANCE_HD real reach(std::uint32_t part) const { return may_be[part]; }
  CLEARANCE_HD real reach(std::uint32_t part, real found, real) const {
    return found <= is[part] ? -infinity : is[part];
  }
  CLEARANCE_HD bool settled(std::uint32_t cloud, std::uint32_t point, std::uint32_t part) const {
    return load_relaxed(word) < key(cloud, point, part);  // an uncertain pair is greater than any key
  }
  CLEARANCE_HD bool ended(std::uint32_t cloud, std::uint32_t point) const { return settled(cloud, point, 0); }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    const unsigned long long mine =
        key(pair.cloud, pair.point, pair.part) | (pair.distance <= is[pair.part] ? 0 : uncertain);
    if (mine < load_relaxed(word)) lower_to(word, mine);
  }
};
static_assert(ending_answer<first_within> && coarse_answer<first_within>);

}  // namespace clearance::pairwise
