// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Where neighbouring points of a cloud are, kept from the first scan, so that later scans need not read them.

#include <clearance/points/passes_on.hpp>
#include <clearance/scan/tile_scan.hpp>

#include <algorithm>

namespace clearance::scan {

/// A box around the valid ones of `piece_points` neighbours, or around the ways of their capsules, which are at most so
/// wide; and how many are invalid. It fills a cache line, because several threads write neighbouring pieces.
struct alignas(64) boxed_piece {
  extent box;
  std::uint32_t dropped[drop_reasons] = {};
  real wide = 0;

  CLEARANCE_HD bool empty() const { return !(box.lower.x <= box.upper.x); }
  /// Point i of a source.
  template <point_source S>
  CLEARANCE_HD void add(const S& source, std::size_t i) {
    const sample s = source[i];
    for (int r = 1; r < drop_reasons; ++r) dropped[r] += int(s.dropped) == r;
    if (!s.valid()) return;
    box.add(s.position);
    if constexpr (capsule_source<S>) {
      const capsule c = source.around(i, s.position);
      box.add(c.at(1));
      wide = max(wide, c.radius + clearance::detail::noise_along(c));
    }
  }
  CLEARANCE_HD void add(const extent& more, const std::uint32_t (&drops)[drop_reasons]) {
    box.lower = {min(box.lower.x, more.lower.x), min(box.lower.y, more.lower.y), min(box.lower.z, more.lower.z)};
    box.upper = {max(box.upper.x, more.upper.x), max(box.upper.y, more.upper.y), max(box.upper.z, more.upper.z)};
    for (int r = 0; r < drop_reasons; ++r) dropped[r] += drops[r];
  }
  CLEARANCE_HD void add(const boxed_piece& other) {
    add(other.box, other.dropped);
    wide = max(wide, other.wide);
  }
  /// The piece's box less an origin.
  extent box_from(vec3 origin) const { return {box.lower - origin, box.upper - origin}; }
};
static_assert(sizeof(boxed_piece) == 64);

/// The approximate distance of what is in a piece from a ball.
inline double away(const ball& around, const boxed_piece& piece, vec3 origin) {
  const extent box = piece.box_from(origin);
  const auto beyond = [](double low, double high, double c) { return std::max({low - c, c - high, 0.0}); };
  const vec3 c = around.center;
  const double x = beyond(box.lower.x, box.upper.x, c.x), y = beyond(box.lower.y, box.upper.y, c.y),
               z = beyond(box.lower.z, box.upper.z, c.z);
  return std::sqrt(x * x + y * y + z * z) - around.radius - piece.wide;
}

/// A source that records what a host's scan sees of it. `pieces`: one per `piece_points`, which one thread scans; or
/// null. An incomplete last tile is not surveyed: call `add_rest` for it.
template <point_source S>
struct boxing : passes_on<boxing<S>, S> {
  static_assert(points_alone<S>());
  using can = can_all<typename boxing::passed, clearance::can<sources::unfiltered, sources::surveyed>>;

  S source;
  boxed_piece* pieces;
  static constexpr auto viewed = &boxing::source;

  boxing(const S& source, boxed_piece* pieces) : source(source), pieces(pieces) {}

  CLEARANCE_HD sample operator[](std::size_t i) const { return source[i]; }
  bool unfiltered() const {
    if constexpr (unfiltered_source<S>) return source.unfiltered();
    return false;
  }

  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const {
    drop_tally mine;
    if (!scan::survey(source, begin, box, mine)) {
      tile t;
      t.load(source, begin, tile_points, 1, mine);
      box = box_of(t);
    }
    for (int r = 0; r < drop_reasons; ++r) dropped[r] += mine.dropped[r];
    if (pieces == nullptr) return true;
    boxed_piece& piece = pieces[begin / piece_points];
    piece.add(box, mine.dropped);
    return true;
  }
  void add_rest() const {
    for (std::size_t i = source.size() / tile_points * tile_points; pieces != nullptr && i < source.size(); ++i)
      pieces[i / piece_points].add(source, i);
  }
};

/// Boxes around a source's points or capsules: `pieces` has one per `piece_points`.
template <point_source S>
void box_points(const S& source, boxed_piece* pieces) {
  const std::size_t size = source.size();
  for (std::size_t i = 0; i < size; ++i) pieces[i / piece_points].add(source, i);
}

/// Some pieces of a source as one source: its piece k is piece `numbers[k]` of the whole. The whole's last piece, which
/// may be shorter, may only come last.
template <point_source S>
struct listed_pieces : passes_on<listed_pieces<S>, S, sources::capsules, sources::unfiltered, sources::surveyed,
                                 sources::surveyed_around> {
  static_assert(points_or_balls<S>());
  using can = typename listed_pieces::passed;
  static constexpr bool vague = vague_source<S>, balls = ball_source<S>;

  S whole;
  const std::uint32_t* numbers;
  std::size_t count;  ///< Number of points.
  static constexpr auto viewed = &listed_pieces::whole;

  CLEARANCE_HD listed_pieces(const S& whole, const std::uint32_t* numbers, std::size_t count)
      : whole(whole), numbers(numbers), count(count) {}

  CLEARANCE_HD std::size_t size() const { return count; }
  CLEARANCE_HD std::size_t number_in_viewed(std::size_t i) const {
    return numbers[i / piece_points] * piece_points + i % piece_points;
  }
  CLEARANCE_HD sample operator[](std::size_t i) const { return whole[number_in_viewed(i)]; }
};

}  // namespace clearance::scan
