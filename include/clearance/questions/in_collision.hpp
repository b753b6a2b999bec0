// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is any point closer than a margin?

#include <clearance/query/query.hpp>
#include <clearance/robot/widened.hpp>

#include <algorithm>
#include <array>
#include <tuple>

namespace clearance {

/// Whether a point is within a margin (elsewhere: security margin, safety distance), and which point: the same on every
/// run and backend.
struct collision_result {
  /// collision: certainly a point is, which is never said if a cloud is `uncertain`. possible: a point may be. free:
  /// certainly none is, and nothing was too close to be measured. no_data: there was no valid point, or no part.
  clearance::state state = clearance::state::no_data;
  std::uint32_t cloud = none, point = none,
                part = none;  ///< The lowest certain pair (by cloud, point, part), or else the lowest possible one.
  point_counts counts;
};

namespace pairwise {

/// An answer: the first pair within margins, certain pairs before uncertain ones. Pairs after a certain one are not
/// looked at.
struct first_within {
  using can = clearance::can<settling, ending, coarse>;
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
static_assert(explain_answer<first_within>());

/// Makes the result of what a scan keeps; `result` has the counts already.
struct tell_collision {
  const unsigned long long* word;
  const std::uint32_t* first;
  std::uint32_t clouds, parts;
  collision_result* result;

  CLEARANCE_HD void operator()(std::size_t) const {
    const bool too_close = result->counts.dropped[int(drop_reason::too_close)] != 0;
    result->state = result->counts.valid == 0 || parts == 0 ? state::no_data
                    : too_close                             ? state::possible
                                                            : state::free;
    result->cloud = result->point = result->part = none;
    if (*word == first_within::nothing) return;
    const auto where = frames::place_of(std::uint32_t(*word >> 31), first, clouds);
    result->state = (*word & first_within::uncertain) != 0 ? state::possible : state::collision;
    result->cloud = where.cloud;
    result->point = where.point;
    result->part = std::uint32_t(*word) & 0x7fffffff;
  }
};

}  // namespace pairwise

/// Is any point closer than the margins? Refused: neither one nor as many margins as parts, one that is NaN, and radii
/// that are negative or not one for all parts, one per part or none.
struct in_collision {
  std::vector<double> margins = {0.0};  ///< Metres: one for all parts, or one per part.
  std::vector<double> radii = {};       ///< By how much parts may be elsewhere, in metres: all alike, or each.

  using result = collision_result;
  using can = clearance::can<checking, counting, concluding, skipping, numbering, merging, partial>;
  using out = collision_result*;  ///< In memory that the backend writes.

  void check(std::size_t parts) const {
    frames::check_margins(margins, parts);
    check_radii(radii, parts);
  }

  template <class Asked>
  out space(const Asked& a) const {
    return a.template space<collision_result>(1);
  }
  static point_counts* counts_of(const out& to) { return &to->counts; }
  template <class Asked, class Clouds>
  pairwise::first_within prepare(const Asked& a, const out&, const Clouds& clouds) const {
    const std::size_t parts = a.parts();
    check(parts);
    a.reaches.resize(2 * parts);
    for (std::size_t k = 0; k < parts; ++k) {
      const double margin = margins[margins.size() == 1 ? 0 : k];
      const part_facts facts = widened(a.facts[k], radius_of(radii, k));
      a.reaches[k] = frames::may_be_within(margin, facts, a.frame.error);
      a.reaches[parts + k] = frames::is_within(margin, facts, a.frame.error);
    }
    if (any_vague(clouds)) std::fill_n(a.reaches.begin() + std::ptrdiff_t(parts), parts, -infinity);
    const auto [word, near, start] = a.put(std::array{pairwise::first_within::nothing}, a.reaches, a.first);
    return {word, near, near + parts, start};
  }
  template <class Asked>
  void conclude(const Asked& a, const pairwise::first_within& found, const out& to) const {
    a.on.for_each(1, pairwise::tell_collision{found.word, found.first_point, std::uint32_t(a.first.size()),
                                              std::uint32_t(a.parts()), to});
  }
  template <class Asked>
  result read(const Asked& a, const out& from) const {
    return a.copy_out(from, 1)[0];
  }

  /// No farther point of a part matters.
  real reach(std::size_t part, std::size_t, const part_facts& facts, const frames::float_error& error) const {
    return frames::may_be_within(margins[margins.size() == 1 ? 0 : part], widened(facts, radius_of(radii, part)),
                                 error);
  }
  /// Also the state, if there is no pair.
  static void set_counts(result& r, const point_counts& counts) {
    r.counts = counts;
    if (r.cloud == none && counts.valid != 0 && r.state == state::no_data) r.state = state::free;
    if (r.state == state::free && counts.dropped[int(drop_reason::too_close)] != 0) r.state = state::possible;
  }
  static void place_in_whole(result& r, const piece_place& place) {
    if (r.cloud != none) r.point += place.first[r.cloud];
  }
  static void merge(result& whole, const result& other) {
    const auto order = [](const result& r) {  // certain pairs first, then the lowest
      return std::tuple(r.cloud == none, r.state != state::collision, r.cloud, r.point, r.part);
    };
    const bool some = whole.state != state::no_data || other.state != state::no_data;
    point_counts counts = whole.counts;
    counts.add(other.counts);
    if (order(other) < order(whole)) whole = other;
    whole.counts = counts;
    if (whole.cloud == none && some)
      whole.state = counts.dropped[int(drop_reason::too_close)] != 0 ? state::possible : state::free;
  }
  static void so_far(result& r, std::uint64_t unseen) {
    if (unseen != 0 && r.state != state::collision) r.state = state::possible;
  }
};

}  // namespace clearance
