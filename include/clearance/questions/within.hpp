// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which points are within a distance of each part?

#include <clearance/query/query.hpp>

#include <algorithm>

namespace clearance {

/// Points near parts. The pairs of part k are offsets[k] to offsets[k + 1] - 1, the nearest first, then by cloud and
/// point.
struct within_result {
  std::vector<std::size_t> offsets;  ///< Where each part's pairs begin, and the number of all.
  std::vector<pair_distance> pairs;  ///< The pairs, with distances as computed, in metres.
  point_counts counts;
  distance_certainty certain;  ///< What is certain of each pair's distance, by its part.
};

namespace pairwise {

/// An answer: a list of pairs in the order in which they are found.
struct listed {
  using can = clearance::can<>;
  pair_distance* pairs;
  unsigned long long* count;  ///< Counts all pairs; those beyond `capacity` are not kept.
  unsigned long long capacity;
  const real* reaches;  ///< One per part.

  CLEARANCE_HD real reach(std::uint32_t part) const { return reaches[part]; }
  CLEARANCE_HD void take(const pair_distance& pair) const {
    if (const unsigned long long i = take_number(count); i < capacity) pairs[i] = pair;
  }
};
static_assert(explain_answer<listed>());

/// Puts pairs in order: by part, distance, cloud and point.
inline void put_in_order(within_result& r, std::size_t parts) {
  std::sort(r.pairs.begin(), r.pairs.end(), [](const pair_distance& a, const pair_distance& b) {
    return std::tie(a.part, a.distance, a.cloud, a.point) < std::tie(b.part, b.distance, b.cloud, b.point);
  });
  r.offsets.assign(parts + 1, 0);
  for (const pair_distance& pair : r.pairs) ++r.offsets[pair.part + 1];
  for (std::size_t k = 0; k < parts; ++k) r.offsets[k + 1] += r.offsets[k];
}

}  // namespace pairwise

/// All pairs of a point and a part whose computed distance is at most `radius` metres. Refused: neither one nor as many
/// radii as parts, and one that is NaN.
struct within {
  std::vector<double> radius;  ///< Metres: one for all parts, or one per part.

  using result = within_result;
  using can = clearance::can<checking, retrying, skipping, numbering, merging>;
  /// Up to `capacity` pairs, in any order, in memory that the backend writes; `count` becomes how many there are: if
  /// that is more, some were cut.
  struct out {
    pair_distance* pairs;
    std::size_t capacity;
    unsigned long long* count;
    point_counts* counts;
  };

  void check(std::size_t parts) const {
    if (radius.size() != 1 && radius.size() != parts)
      throw std::invalid_argument("clearance: there are " + std::to_string(parts) + " parts, but " +
                                  std::to_string(radius.size()) + " radii");
    for (std::size_t k = 0; k < radius.size(); ++k)
      if (!(radius[k] == radius[k]))
        throw std::invalid_argument("clearance: the radius of part " + std::to_string(k) + " is not a number");
  }

  template <class Asked>
  out space(const Asked& a, std::size_t least = 0) const {
    const auto list = a.memory.template space<pair_distance>(std::max<std::size_t>(least, 1 << 16));
    return {list.data(), list.size(), a.template space<unsigned long long>(1), a.template space<point_counts>(1)};
  }
  template <class Asked>
  pairwise::listed prepare(const Asked& a, const out& to) const {
    check(a.parts());
    a.reaches.clear();
    for (std::size_t k = 0; k < a.parts(); ++k)
      a.reaches.push_back(frames::largest_within(radius[radius.size() == 1 ? 0 : k]));
    const auto [reaches] = a.put(a.reaches);
    const unsigned long long nothing = 0;
    a.on.stage(std::span(&nothing, 1), to.count);
    return {to.pairs, to.count, to.capacity, reaches};
  }
  /// Reads the result, or says how much room it takes if there was not enough.
  template <class Asked>
  std::size_t more(const Asked& a, const out& from, result& r) const {
    unsigned long long found = 0;
    a.bring(backends::read_value{found, from.count},
            backends::read_array{r.pairs, from.pairs, from.capacity, from.count},
            backends::read_value{r.counts, from.counts});
    if (found > from.capacity) return std::size_t(found);
    r.certain = a.certain();
    pairwise::put_in_order(r, a.parts());
    return 0;
  }
  /// Those that there was room for.
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    result r;
    more(a, from, r);
    return r;
  }

  /// No farther point of a part matters.
  real reach(std::size_t part, std::size_t, const part_facts&, const frames::float_error&) const {
    return frames::largest_within(radius[radius.size() == 1 ? 0 : part]);
  }
  static void set_counts(result& r, const point_counts& counts) { r.counts = counts; }
  static void place_in_whole(result& r, const piece_place& place) {
    for (pair_distance& pair : r.pairs) pair.point += place.first[pair.cloud];
  }
  static void merge(result& all, const result& other) {
    all.pairs.insert(all.pairs.end(), other.pairs.begin(), other.pairs.end());
    all.counts.add(other.counts);
    all.certain.widen(other.certain);
    pairwise::put_in_order(all, all.offsets.size() - 1);
  }
};

}  // namespace clearance
