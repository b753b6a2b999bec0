// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An answer that distinguishes any two sets of pairs, in whatever order they come.

#include "support/brute_pairs.hpp"

#include <clearance/ground/ordered.hpp>

#include <bit>

namespace testing {

CLEARANCE_HD inline unsigned long long mixed(unsigned long long h) {
  h ^= h >> 31, h *= 0x7fb5d329728ea185ull, h ^= h >> 27, h *= 0x81dadef4bc2dd44dull;
  return h ^ h >> 33;
}

/// Sums hashes of the pairs within reach; odd parts reach half as far.
struct tallied {
  real farthest;
  unsigned long long* words;  ///< Two: the number of pairs, and the sum of their hashes.

  CLEARANCE_HD real reach(std::uint32_t part) const { return part % 2 == 0 ? farthest : farthest / 2; }
  CLEARANCE_HD void take(const clearance::pair_distance& p) const {
    clearance::add_to(words, 1);
    clearance::add_to(words + 1,
                      mixed(mixed(mixed(p.cloud + 1ull) ^ p.point) ^ (std::uint64_t(p.part) << 32 | p.primitive)) ^
                          mixed(clearance::to_bits(p.distance + 0.0f)));
  }
};

struct tally_of_pairs {
  unsigned long long words[2] = {};
  friend bool operator==(const tally_of_pairs&, const tally_of_pairs&) = default;
};

/// All points with all primitives of all parts, by definition. `inside(k, q)`: is q in part k's solid?
template <class P, class Inside>
void brute_tally(const scene<P>& s, const std::vector<vec3>& points, const Eigen::Isometry3d& pose, std::uint32_t cloud,
                 real farthest, Inside inside, tally_of_pairs& all) {
  const tallied answer{farthest, all.words};
  for_each_pair(s, clearance::point_span(points), pose, cloud, inside, [&](const clearance::pair_distance& pair) {
    if (pair.distance <= answer.reach(pair.part)) answer.take(pair);
  });
}

}  // namespace testing
