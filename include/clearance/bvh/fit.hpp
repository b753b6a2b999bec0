// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

namespace clearance {

/// Fit rule: a node encloses the balls of all leaves below it. The tighter rule, and the default.
struct wrapped {
  template <class V>
  V operator()(std::span<const ball> leaves, std::span<const V>) const {
    return bounding_volume_traits<V>::fit(leaves);
  }
};

/// Fit rule: a node encloses its children's volumes, as in the first Inner Sphere Trees. Needs a volume with balls().
struct layered {
  template <class V>
  V operator()(std::span<const ball> leaves, std::span<const V> children) const {
    static_assert(
        requires(const V& v) { std::span<const ball>(bounding_volume_traits<V>::balls(v)); },
        "the layered fit needs a volume with balls(): a few balls whose convex hull contains it");
    if (children.empty()) return bounding_volume_traits<V>::fit(leaves);
    std::vector<ball> all;
    for (const V& child : children)
      for (const ball& b : bounding_volume_traits<V>::balls(child)) all.push_back(b);
    return bounding_volume_traits<V>::fit(all);
  }
};

}  // namespace clearance
