// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Points inside a part's solid, whose distance is 0.

#include <clearance/robot/part.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/visitor/any_within.hpp>

namespace clearance::scan {

/// Does this part have a solid besides its primitives?
template <class PartView>
inline constexpr bool has_interior = !std::is_same_v<typename PartView::interior_type, no_interior>;

/// Is a point inside by more than the errors? `error` is that of a distance to the part, in metres.
template <class PartView, class Traversal = near_first>
CLEARANCE_HD bool certainly_inside(const PartView& part, vec3 q, real error, const Traversal& walk = {}) {
  any_within surface{error + part.facts.tolerance};
  walk(part.tree, q, surface);
  return !surface.found;
}

}  // namespace clearance::scan
