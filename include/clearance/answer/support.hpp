// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How many points are around a few candidates.

#include <clearance/ground/ordered.hpp>
#include <clearance/ground/pose.hpp>
#include <clearance/point_source.hpp>

#include <cmath>

namespace clearance::pairwise {

/// A candidate's place in the world, by its number through all clouds; of those that are in this one.
template <point_source Source>
struct place_candidates {
  Source source;
  world_transform world_from_cloud;
  std::uint32_t first;
  const std::uint32_t* number;
  position* at;

  CLEARANCE_HD void operator()(std::size_t c) const {
    if (number[c] >= first && number[c] - first < source.size()) at[c] = world_from_cloud(source[number[c] - first].position);
  }
};

/// A ball in a cloud's frame that contains all that is within `radius` of a place in the world, whatever rounding does.
inline ball around(position at, double radius, const world_transform& world_from_cloud) {
  const auto norm = [](position p) { return std::hypot(p.x, p.y, p.z); };
  const position c = world_from_cloud.inverse()(at);
  const double most = radius * (1 + 0x1p-16) + 0x1p-20 * norm(c) + 0x1p-40 * (norm(at) + norm(world_from_cloud.translation()));
  return {{real(c.x), real(c.y), real(c.z)}, rounded_up(most)};
}

/// One more of a cloud's points: is it within `radius` of candidates? In world coordinates, in double; itself counts, too. Candidates that
/// have enough are not asked again.
template <point_source Source>
struct count_support {
  Source source;
  world_transform world_from_cloud;
  ball all;                ///< Around all balls.
  const ball* near;        ///< One a candidate.
  const position* at;      ///< Likewise,
  std::uint32_t* support;  ///< and so are their counts: at least `enough`, if there are so many.
  std::uint32_t candidates, enough;
  double square;  ///< Of the radius.

  CLEARANCE_HD void operator()(std::size_t i) const {
    const sample s = source[i];
    if (!s.valid() || !may_be_in(all, s.position)) return;
    for (std::uint32_t c = 0; c < candidates; ++c) {
      if (!may_be_in(near[c], s.position) || load_relaxed(support + c) >= enough) continue;
      const position p = world_from_cloud(s.position), d{p.x - at[c].x, p.y - at[c].y, p.z - at[c].z};
      if (fma(d.x, d.x, fma(d.y, d.y, d.z * d.z)) <= square) count_one(support + c);
    }
  }

 private:
  CLEARANCE_HD static bool may_be_in(const ball& b, vec3 p) {
    const vec3 d = p - b.center;
    return d.x * d.x + d.y * d.y + d.z * d.z <= b.radius * b.radius * (1 + 4 * slack);
  }
};

}  // namespace clearance::pairwise
