// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Merges two answers into one.

#include <clearance/frames/bracket.hpp>

#include <algorithm>

namespace clearance {

namespace minimum {

/// Is a's witness the better one? Compares distance, cloud, point, part, primitive.
CLEARANCE_HD inline bool nearer(const min_distance_result& a, const min_distance_result& b) {
  if (a.part == none || b.part == none) return b.part == none && a.part != none;
  if (a.distance != b.distance) return a.distance < b.distance;
  if (a.cloud != b.cloud) return a.cloud < b.cloud;
  if (a.point != b.point) return a.point < b.point;
  if (a.part != b.part) return b.part > a.part;
  return a.primitive < b.primitive;
}

/// Witness and bracket of both; the counts are a's.
CLEARANCE_HD inline min_distance_result merged(const min_distance_result& a, const min_distance_result& b) {
  const bool lost = (a.part == none && a.state == state::possible) ||
                    (b.part == none && b.state == state::possible);                    // a pose was not rigid
  const bool nothing = a.part == none && b.part == none && a.state == state::no_data;  // b may know that all are far
  min_distance_result r = nothing || nearer(b, a) ? b : a;
  r.seen = a.seen;
  r.valid = a.valid;
  for (int k = 0; k < drop_reasons; ++k) r.dropped[k] = a.dropped[k];
  if (a.state == state::collision || b.state == state::collision) {
    r.state = state::collision;
    r.lower = r.upper = 0;
  } else if (a.part != none && b.part != none) {
    r.lower = min(a.lower, b.lower);
    r.state = r.lower > 0 ? state::free : state::possible;
  }
  if (lost && r.state != state::collision) {
    r.state = state::possible;
    r.lower = 0;
  }
  return r;
}

}  // namespace minimum

/// Merges answers about the same robot in the same poses and different points: clouds, or pieces of one, with the
/// numbers of the whole (`renumbered`). Witness and counts are those of one call. So is the bracket for pieces of one
/// cloud; otherwise it may be narrower.
CLEARANCE_HD inline min_distance_result merge(const min_distance_result& a, const min_distance_result& b) {
  min_distance_result r = minimum::merged(a, b);
  r.seen += b.seen;
  r.valid += b.valid;
  for (int k = 0; k < drop_reasons; ++k) r.dropped[k] += b.dropped[k];
  frames::allow_for_too_close(r);
  return r;
}
CLEARANCE_HD inline part_minimum merge(const part_minimum& a, const part_minimum& b) {
  if (a.cloud == none || b.cloud == none) return a.cloud == none ? b : a;
  if (a.distance != b.distance) return a.distance < b.distance ? a : b;
  if (a.cloud != b.cloud) return a.cloud < b.cloud ? a : b;
  return a.point <= b.point ? a : b;
}

/// Gives an answer about one cloud, or a piece of it, the numbers of the whole: it was cloud `cloud`, and the piece
/// began at point `first`.
template <class Answer>
CLEARANCE_HD Answer renumbered(Answer r, std::uint32_t cloud, std::uint32_t first = 0) {
  if (r.cloud != none) {
    r.cloud += cloud;
    r.point += first;
  }
  return r;
}

}  // namespace clearance

namespace clearance::minimum {

/// Adds answers about pieces of the same clouds, or about groups of a robot's parts, in the numbers of the whole, up to
/// the answer of one call. Plain data. Adding is associative and commutative.
struct of_pieces {
  min_distance_result all;
  // What the nearest pair alone shows.
  clearance::state nearest_state;
  real nearest_upper;

  of_pieces() = default;
  CLEARANCE_HD explicit of_pieces(const min_distance_result& piece)
      : all(piece), nearest_state(piece.state), nearest_upper(piece.upper) {}

  /// Adds an answer about other points.
  CLEARANCE_HD void add(const of_pieces& other) {
    consider(other);
    all = merge(all, other.all);
  }
  /// Adds an answer about other parts and the same points.
  CLEARANCE_HD void add_parts(const of_pieces& other) {
    consider(other);
    all = merged(all, other.all);
  }

  /// Without a solid (`has_interior`) only the nearest pair decides whether a point is certainly inside. The nearest
  /// pair of another piece may be certainly inside although it is less deep, if its part has a smaller tolerance.
  CLEARANCE_HD min_distance_result answer(bool has_interior) const {
    min_distance_result r = all;
    if (!has_interior && r.state == state::collision && nearest_state != state::collision) {
      r.state = state::possible;
      r.upper = nearest_upper;
    }
    return r;
  }

 private:
  CLEARANCE_HD void consider(const of_pieces& other) {
    if (nearer(other.all, all)) {
      nearest_state = other.nearest_state;
      nearest_upper = other.nearest_upper;
    }
  }
};

}  // namespace clearance::minimum
