// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/query/nearest.hpp>
#include <clearance/search/point_body.hpp>

namespace clearance::search {

/// A few points spread over the cloud, each taken greedily to one leaf, before all others: any real pair is a valid bound,
/// and a good one saves the rest most of the work. Without it, thousands of threads would start from infinity at once.
template <class PointBody>
struct seed_body {
  static constexpr std::size_t samples = 2048;

  PointBody body;
  std::size_t stride;

  CLEARANCE_HD void operator()(std::size_t i) const {
    const sample s = body.source[i * stride];
    if (!s.valid()) return;
    const vec3 p = s.position - body.origin;
    const auto index = body.first + std::uint32_t(i * stride);
    std::uint32_t nearest_part = 0;
    real least = infinity;
    for (std::uint32_t k = 0; k < body.part_count; ++k) {
      if (body.part_best != nullptr) descend(p, index, k);  // every part wants a bound of its own
      const ball& around = body.places[k].around;
      const real lb = length(p - around.center) - around.radius;
      if (lb < least) least = lb, nearest_part = k;
    }
    if (body.part_best == nullptr) descend(p, index, nearest_part);
  }

  /// One pair of a point and a part, for a bound that something attains.
  CLEARANCE_HD void descend(vec3 p, std::uint32_t index, std::uint32_t k) const {
    const auto& tree = body.parts[k].tree;
    const vec3 q = body.places[k].part_from_cloud(p);
    using traits = bounding_volume_traits<std::remove_cvref_t<decltype(tree.volume(tree.root()))>>;
    auto n = tree.root();
    while (!tree.is_leaf(n)) {
      auto next = tree.child(n, 0);
      real least = infinity;
      for (std::uint32_t c = 0; c < tree.size(n); ++c) {
        const auto child = tree.child(n, c);
        const real lb = traits::lower_bound(tree.volume(child), q);
        if (lb < least) least = lb, next = child;
      }
      n = next;
    }
    nearest found;
    offer_leaf(tree, n, q, found);
    if (found.best == nearest::none) return;
    const distance_key key = make_key(found.within, index);
    if (distance_key* const bound = body.bound_of(k); key < load_relaxed(bound)) lower_to(bound, key);
  }
};

}  // namespace clearance::search
