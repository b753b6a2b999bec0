// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/minimum/merge.hpp>

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
    look(other);
    all = merge(all, other.all);
  }
  /// Adds an answer about other parts and the same points.
  CLEARANCE_HD void add_parts(const of_pieces& other) {
    look(other);
    all = merged(all, other.all);
  }

  /// Without a solid (`has_interior`) only the nearest pair decides whether a point is certainly inside. The nearest
  /// pair of another piece may be certainly inside although it is less deep, if its part has a smaller tolerance.
  CLEARANCE_HD min_distance_result answer(bool has_interior) const {
    min_distance_result r = all;
    if (!has_interior && r.state == state::collision && nearest_state != state::collision)
      r.state = state::possible, r.upper = nearest_upper;
    return r;
  }

 private:
  CLEARANCE_HD void look(const of_pieces& other) {
    if (nearer(other.all, all)) nearest_state = other.nearest_state, nearest_upper = other.nearest_upper;
  }
};

}  // namespace clearance::minimum
