// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance by definition, and how a result differs from it.

#include "support/brute_pairs.hpp"
#include "support/product.hpp"

#include <clearance/questions/distances.hpp>

namespace testing {

/// Compares all points of a source with all primitives of all parts. `inside(k, q)`: is q in part k's solid?
template <class P, class Source, class Inside>
clearance::point_distances brute_distances(const scene<P>& s, const Source& source, const Eigen::Isometry3d& pose,
                                           real d_max, Inside inside) {
  clearance::point_distances all;
  for (std::size_t i = 0; i < source.size(); ++i) {
    const clearance::sample point = source[i];
    all.distance.push_back(point.valid() ? clearance::infinity : clearance::not_a_number);
    ++all.counts.seen;
    all.counts.valid += point.valid();
    if (!point.valid()) ++all.counts.dropped[int(point.dropped)];
  }
  all.part = all.primitive = std::vector<std::uint32_t>(source.size(), ~0u);
  for_each_pair(s, source, pose, 0, inside, [&](const clearance::pair_distance& pair) {
    if (!(pair.distance <= d_max && pair.distance < all.distance[pair.point])) return;
    all.distance[pair.point] = pair.distance, all.part[pair.point] = pair.part,
    all.primitive[pair.point] = pair.primitive;
  });
  return all;
}

inline bool same_counts(const clearance::point_counts& a, const clearance::point_counts& b) {
  return a.seen == b.seen && a.valid == b.valid && std::ranges::equal(a.dropped, b.dropped);
}

/// Appends the expected result of the next cloud to that of the others.
inline void append(clearance::point_distances& all, const clearance::point_distances& next) {
  all.distance.insert(all.distance.end(), next.distance.begin(), next.distance.end());
  all.part.insert(all.part.end(), next.part.begin(), next.part.end());
  all.primitive.insert(all.primitive.end(), next.primitive.begin(), next.primitive.end());
  all.counts.seen += next.counts.seen, all.counts.valid += next.counts.valid;
  for (int k = 0; k < clearance::drop_reasons; ++k) all.counts.dropped[k] += next.counts.dropped[k];
}

inline void require_same(const clearance::point_distances& found, const clearance::point_distances& expected,
                         verdict& v, const std::string& what) {
  std::size_t wrong = 0, first = 0;
  const auto bits = [](real x) { return x == x ? clearance::to_bits(x + 0.0f) : 0x7fc00000u; };
  const bool whole = found.distance.size() == expected.distance.size() && found.part.size() == found.primitive.size() &&
                     (found.part.empty() || found.part.size() == found.distance.size());
  v.require(whole, what, ": ", found.distance.size(), " distances");
  for (std::size_t i = 0; whole && i < expected.distance.size(); ++i)
    if (bits(found.distance[i]) != bits(expected.distance[i]) ||
        (!found.part.empty() && (found.part[i] != expected.part[i] || found.primitive[i] != expected.primitive[i])))
      if (wrong++ == 0) first = i;
  if (wrong != 0)
    v.require(false, what, ": ", wrong, " points differ, first ", first, ": ", found.distance[first], " and not ",
              expected.distance[first], ", part ", found.part.empty() ? 0 : found.part[first], " and not ",
              expected.part.empty() ? 0 : expected.part[first], ", primitive ",
              found.part.empty() ? 0 : found.primitive[first], " and not ",
              expected.primitive.empty() ? 0 : expected.primitive[first]);
  v.require(same_counts(found.counts, expected.counts), what, ": other counts");
}

/// A scene's points, alone and with a depth image: what `on` says with each point's part and primitive, and without.
template <class P, class On, class Model>
void hold_distances(const On& on, const scene<P>& s, const Model& model, verdict& v) {
  using clearance::ask, clearance::distances;
  const sources<P> all(s);
  const clearance::placed cloud{all.span, s.cloud_pose};
  const clearance::placed image{all.raw, all.camera_pose};
  for (const real d_max : {real(-0.05), real(0), real(0.2), real(3), clearance::infinity}) {
    const std::string what = s.name + ", d_max " + std::to_string(d_max);
    auto expected = brute_distances(s, all.span, s.cloud_pose, d_max, nothing_inside);
    require_same(ask(on, model, s.poses, cloud, distances{d_max, true}), expected, v, what);
    require_same(ask(on, model, s.poses, cloud, distances{d_max}), expected, v, what + ", distances alone");
    append(expected, brute_distances(s, all.raw, all.camera_pose, d_max, nothing_inside));
    require_same(ask(on, model, s.poses, std::tuple(cloud, image), distances{d_max, true}), expected, v,
                 what + ", two clouds");
  }
}

}  // namespace testing
