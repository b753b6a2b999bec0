// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How many points are in zones around parts, as an answer that gets pairs.

#include <clearance/frame/clouds.hpp>
#include <clearance/result.hpp>
#include <clearance/ground/ordered.hpp>

namespace clearance::pairwise {

/// What a scan keeps of one zone of one part. Points are numbered through all clouds.
struct zone_words {
  unsigned long long points = 0;
  distance_key nearest = no_key;     ///< (distance, point)
  unsigned long long first = ~0ull;  ///< The lowest point.
};

/// The answer: zones of each part, the innermost first.
struct count_in_zones {
  zone_words* words;                 ///< `zones` a part.
  const real* reaches;               ///< As many: how near a point must be to be counted.
  const std::uint32_t* first_point;  ///< Of each cloud.
  std::uint32_t zones;

  CLEARANCE_HD real reach(std::uint32_t part) const { return zones == 0 ? -infinity : reaches[part * zones + zones - 1]; }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    const std::uint32_t number = first_point[pair.cloud] + pair.point;
    for (std::uint32_t z = zones; z-- > 0 && pair.distance <= reaches[pair.part * zones + z];) {
      zone_words& zone = words[pair.part * zones + z];
      add_one(&zone.points);
      if (const distance_key key = make_key(pair.distance, number); key < load_relaxed(&zone.nearest)) lower_to(&zone.nearest, key);
      if (number < load_relaxed(&zone.first)) lower_to(&zone.first, number);
    }
  }
};

}  // namespace clearance::pairwise
