// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What a walk on a device finds.

#include <clearance/ground/ordered.hpp>
#include <clearance/result.hpp>

namespace clearance::scan {

/// A primitive near a point, with all that names it, so that it need not be searched for again.
template <class Place>
struct record {
  distance_key key = no_key;
  std::uint32_t part = none;
  std::uint32_t id =
      none;          ///< The primitive's number in the user's array (none: the point is inside, no primitive is known),
  Place place = {};  ///< and where in the tree it is.
};

/// Lexicographic: distance, point, part, primitive.
template <class Place>
CLEARANCE_HD bool before(const record<Place>& a, const record<Place>& b) {
  if (a.key != b.key) return a.key < b.key;
  if (a.part != b.part) return b.part > a.part;  // a `<` after a dependent `part` would begin the template of that name
  return a.id < b.id;
}

template <class Place>
CLEARANCE_HD bool same(const record<Place>& a, const record<Place>& b) {
  return a.key == b.key && a.part == b.part && a.id == b.id;
}

}  // namespace clearance::scan
