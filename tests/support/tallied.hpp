// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An answer that tells any two sets of pairs apart, whatever order they come in.

#include "support/scenes.hpp"

#include <clearance/ground/ordered.hpp>

#include <bit>

namespace testing {

CLEARANCE_HD inline unsigned long long mixed(unsigned long long h) {
  h ^= h >> 31, h *= 0x7fb5d329728ea185ull, h ^= h >> 27, h *= 0x81dadef4bc2dd44dull;
  return h ^ h >> 33;
}

/// Sums of hashes of the pairs that are within reach; odd parts reach half as far.
struct tallied {
  real farthest;
  unsigned long long* words;  ///< Two: how many pairs, and the sum of their hashes.

  CLEARANCE_HD real reach(std::uint32_t part) const { return part % 2 == 0 ? farthest : farthest / 2; }
  CLEARANCE_HD void take(const clearance::pair_distance& p) const {
    clearance::add_to(words, 1);
    clearance::add_to(words + 1, mixed(mixed(mixed(p.cloud + 1ull) ^ p.point) ^ (std::uint64_t(p.part) << 32 | p.primitive)) ^
                                     mixed(clearance::to_bits(p.distance + 0.0f)));
  }
};

struct tally_of_pairs {
  unsigned long long words[2] = {};
  friend bool operator==(const tally_of_pairs&, const tally_of_pairs&) = default;
};

/// All points against all primitives of all parts, by the definition. `inside(k, q)`: is q in part k's solid?
template <class P, class Inside>
void brute_tally(const scene<P>& s, const std::vector<vec3>& points, const Eigen::Isometry3d& pose, std::uint32_t cloud, real farthest, Inside inside,
                 tally_of_pairs& all) {
  std::vector<clearance::part_facts> facts;
  for (const auto& primitives : s.parts) {
    const ball around = clearance::enclosing_ball(std::span<const P>(primitives));
    facts.push_back({around.center, around.radius, 0, 0});
  }
  const clearance::frames::cloud_frame frame(facts, s.poses, pose);
  const tallied answer{farthest, all.words};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!clearance::is_finite(points[i])) continue;
    for (std::uint32_t k = 0; k < s.parts.size(); ++k) {
      const vec3 q = frame.places[k].part_from_cloud(points[i] - frame.origin);
      clearance::pair_distance pair{cloud, i, k, ~0u, clearance::infinity};
      if (inside(k, q)) {
        pair.distance = 0;
      } else {
        for (std::uint32_t n = 0; n < s.parts[k].size(); ++n)
          if (const real d = s.parts[k][n].distance(q); d < pair.distance) pair.distance = d, pair.primitive = n;
      }
      if (pair.distance <= answer.reach(k)) answer.take(pair);
    }
  }
}

}  // namespace testing
