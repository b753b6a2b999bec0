// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Counts the points around a few candidates.

#include <clearance/backend/host.hpp>
#include <clearance/frame/frame.hpp>
#include <clearance/frame/root_test.hpp>
#include <clearance/ground/ordered.hpp>
#include <clearance/ground/vectors.hpp>
#include <clearance/point_source.hpp>
#include <clearance/scan/interior.hpp>
#include <clearance/traversal/any_depth.hpp>

#include <cmath>

namespace clearance::pairwise {

/// Computes where candidates are in the world, from their numbers through all clouds, if they are in this cloud.
template <point_source Source>
struct place_candidates {
  Source source;
  world_transform world_from_cloud;
  std::uint32_t first;
  const std::uint32_t* number;
  position* at;

  CLEARANCE_HD void operator()(std::size_t c) const {
    if (number[c] >= first && number[c] - first < source.size())
      at[c] = world_from_cloud(source[number[c] - first].position);
  }
};

/// A ball in a cloud's frame around a place in the world, safe against rounding. Points within `radius` of the place
/// are in the ball. Points within `all_within` of its middle are within `radius`; if that is negative, no point is.
struct place_around {
  ball near;
  double all_within;
};
inline place_around around(position at, double radius, const world_transform& world_from_cloud) {
  const auto norm = [](position p) { return std::hypot(p.x, p.y, p.z); };
  const position c = world_from_cloud.inverse()(at);
  const double off = radius * 0x1p-16 + 0x1p-20 * norm(c) + 0x1p-40 * (norm(at) + norm(world_from_cloud.translation()));
  return {{{real(c.x), real(c.y), real(c.z)}, rounded_up(radius + off)}, radius - off};
}

/// Counts one of a cloud's points for each candidate within the radius, in world coordinates and double. A candidate
/// counts itself. Candidates that have enough are not tested again.
template <point_source Source>
struct count_support {
  Source source;
  world_transform world_from_cloud;
  ball all;                ///< Around all balls.
  const ball* near;        ///< One per candidate.
  const position* at;      ///< One per candidate.
  std::uint32_t* support;  ///< One count per candidate: at least `enough`, if so many points are near.
  std::uint32_t candidates, enough;
  double square;  ///< Of the radius.

  CLEARANCE_HD void operator()(std::size_t i) const {
    const sample s = source[i];
    if (!s.valid() || !may_be_in(all, s.position)) return;
    for (std::uint32_t c = 0; c < candidates; ++c)
      if (may_be_in(near[c], s.position) && load_relaxed(support + c) < enough &&
          confirms(world_from_cloud(s.position), c))
        count_one(support + c);
  }
  CLEARANCE_HD bool confirms(position p, std::uint32_t c) const {
    const position d{p.x - at[c].x, p.y - at[c].y, p.z - at[c].z};
    return fma(d.x, d.x, fma(d.y, d.y, d.z * d.z)) <= square;
  }

 private:
  CLEARANCE_HD static bool may_be_in(const ball& b, vec3 p) {
    const vec3 d = p - b.center;
    return d.x * d.x + d.y * d.y + d.z * d.z <= b.radius * b.radius * (1 + 4 * slack);
  }
};

/// The same on a host, for many neighbours at once: mostly a candidate's ball contains all of them or none.
template <point_source Source>
struct count_support_of_pieces {
  count_support<Source> each;
  const double* all_within;  ///< One per candidate.

  void operator()(indices range) const {
    with_vectors([&] {
      for (std::size_t i = range.begin; i < range.end; i += most) count(i, std::min(range.end, i + most));
    });
  }

 private:
  static constexpr std::size_t most = 1024;

  void count(std::size_t begin, std::size_t end) const {
    position at[most];
    extent box;
    std::uint32_t valid = 0;
    for (std::size_t i = begin; i < end; ++i)
      if (const sample s = each.source[i]; s.valid())
        box.add(s.position), at[valid++] = each.world_from_cloud(s.position);
    if (valid == 0 || !(nearest(box, each.all.center) <= each.all.radius)) return;
    for (std::uint32_t c = 0; c < each.candidates; ++c) {
      const ball& near = each.near[c];
      if (!(nearest(box, near.center) <= near.radius) || load_relaxed(each.support + c) >= each.enough) continue;
      std::uint32_t its = farthest(box, near.center) <= all_within[c] ? valid : 0;
      if (its == 0)
        for (std::uint32_t j = 0; j < valid; ++j) its += each.confirms(at[j], c);
      if (its != 0) count_one(each.support + c, its);
    }
  }
  static double nearest(const extent& box, vec3 p) {
    const auto beyond = [](double low, double high, double x) { return std::fmax(std::fmax(low - x, x - high), 0); };
    return norm(beyond(box.lower.x, box.upper.x, p.x), beyond(box.lower.y, box.upper.y, p.y),
                beyond(box.lower.z, box.upper.z, p.z)) *
           (1 - 0x1p-40);
  }
  static double farthest(const extent& box, vec3 p) {
    const auto away = [](double low, double high, double x) { return std::fmax(high - x, x - low); };
    return norm(away(box.lower.x, box.upper.x, p.x), away(box.lower.y, box.upper.y, p.y),
                away(box.lower.z, box.upper.z, p.z)) *
           (1 + 0x1p-40);
  }
  static double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }
};

/// Which candidates are certainly inside a part's solid.
template <class PartView, point_source Source>
struct find_inside {
  const PartView* parts;
  const frames::placement* places;
  std::uint32_t part_count;
  Source source;
  vec3 origin;
  std::uint32_t first;
  const std::uint32_t* number;
  std::uint32_t* inside;  ///< One per candidate; becomes 1 if it is certainly inside.
  any_depth walk;

  CLEARANCE_HD void operator()(std::size_t c) const {
    if (number[c] < first || number[c] - first >= source.size()) return;
    const vec3 p = source[number[c] - first].position - origin;
    for (std::uint32_t k = 0; k < part_count; ++k) {
      if (!frames::may_reach(places[k].around, 0, p)) continue;
      const vec3 q = places[k].part_from_cloud(p);
      if (parts[k].interior.inside(q) && scan::certainly_inside(parts[k], q, places[k].error, walk)) inside[c] = 1;
    }
  }
};

}  // namespace clearance::pairwise
