// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How many points are in zones around parts: an answer that gets pairs.

#include <clearance/frame/clouds.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>

namespace clearance::pairwise {

/// What a scan keeps for one zone of one part, without the zones inside it. Points are numbered through all clouds.
struct zone_words {
  unsigned long long points = 0;
  distance_key nearest = no_key;  ///< (distance, point)
  std::uint32_t first = ~0u;      ///< The lowest point.
};

/// The answer: zones of each part, the innermost first. A point is counted in its innermost zone. Its exact distance
/// matters only if it may be the nearest.
struct count_in_zones {
  static constexpr std::uint32_t copies =
      8;  ///< Copies of all words, so that threads do not wait for one another. They are joined at the end.

  zone_words* words;                 ///< `zones` per part, `total` per copy.
  const real* reaches;               ///< `zones` per part: how near a point must be to be counted.
  const std::uint32_t* first_point;  ///< Per cloud.
  std::uint32_t zones, total;

  CLEARANCE_HD real reach(std::uint32_t part) const {
    return zones == 0 ? -infinity : reaches[part * zones + zones - 1];
  }
  CLEARANCE_HD real reach(std::uint32_t part, real found, real nearest) const {
    const std::uint32_t z = innermost(part, found);
    return max(z == 0 ? -infinity : reaches[part * zones + z - 1], min(found, nearest));
  }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    const std::uint32_t z = innermost(pair.part, pair.distance), number = first_point[pair.cloud] + pair.point;
    if (z == zones) return;
    zone_words& zone = words[copy_for(number) * total + pair.part * zones + z];
    add_one(&zone.points);
    if (const distance_key key = make_key(pair.distance, number); key < load_relaxed(&zone.nearest))
      lower_to(&zone.nearest, key);
    if (number < load_relaxed(&zone.first)) lower_word(&zone.first, number);
  }

  /// Zone `i` of all zones, joined from all copies, with the zones inside it.
  CLEARANCE_HD zone_words joined(std::size_t i) const {
    zone_words all;
    for (std::uint32_t c = 0; c < copies; ++c)
      for (std::size_t k = i - i % zones; k <= i; ++k) {
        const zone_words& w = words[c * total + k];
        all = {all.points + w.points, w.nearest < all.nearest ? w.nearest : all.nearest,
               w.first < all.first ? w.first : all.first};
      }
    return all;
  }

 private:
  CLEARANCE_HD static std::uint32_t copy_for([[maybe_unused]] std::uint32_t number) {
#if defined(__CUDA_ARCH__)
    return blockIdx.x % copies;
#else
    return number / 1024 % copies;
#endif
  }
  /// The innermost zone that contains a point at this distance, or `zones`.
  CLEARANCE_HD std::uint32_t innermost(std::uint32_t part, real distance) const {
    std::uint32_t z = zones;
    while (z > 0 && distance <= reaches[part * zones + z - 1]) --z;
    return z;
  }
};
static_assert(coarse_answer<count_in_zones>);

/// Before the scan: empties all zones.
struct empty_zones {
  zone_words* words;
  CLEARANCE_HD void operator()(std::size_t i) const { words[i] = {}; }
};

}  // namespace clearance::pairwise
