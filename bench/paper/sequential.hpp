// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The paper's competitor on the CPU: Algorithm 1, part by part, point by point, one bound.

#include "bounds.hpp"

#include <clearance/backends/host.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/robot/model.hpp>

#include <mutex>

namespace bench::paper {

template <class Walk, bool Count = false, class PartView, clearance::point_source Source>
real sequential(clearance::model_view<PartView> model, const clearance::frames::cloud_frame& frame, const Source& cloud,
                Walk walk, counts* all = nullptr) {
  own_bound bound;
  for (std::size_t k = 0; k < model.size(); ++k)
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const clearance::sample s = cloud[i];
      if (!s.valid()) continue;
      const clearance::vec3 p = frame.places[k].part_from_cloud(s.position - frame.origin);
      if constexpr (Count) {
        unsigned tests = 0, leaves = 0;
        walk(counted(model.parts[k].tree, &tests, &leaves), p, bound);
        all->tests += tests, all->leaves += leaves;
      } else {
        walk(model.parts[k].tree, p, bound);
      }
    }
  if constexpr (Count) all->accepted += bound.accepted;
  return bound.best;
}

/// Compares every point with every primitive, without tree or bound.
template <class Model, clearance::point_source Source>
real brute_force(const Model& model, const clearance::frames::cloud_frame& frame, const Source& cloud) {
  real least = clearance::infinity;
  std::mutex one_at_a_time;
  clearance::host{}.for_ranges(cloud.size(), [&](clearance::indices range) {
    real mine = clearance::infinity;
    for (std::size_t k = 0; k < model.size(); ++k)
      for (std::size_t i = range.begin; i < range.end; ++i) {
        const clearance::sample s = cloud[i];
        if (!s.valid()) continue;
        const clearance::vec3 p = frame.places[k].part_from_cloud(s.position - frame.origin);
        for (const auto& primitive : model.parts()[k].tree.primitives)
          mine = clearance::min(mine, primitive.distance(p));
      }
    const std::lock_guard lock(one_at_a_time);
    least = clearance::min(least, mine);
  });
  return least;
}

}  // namespace bench::paper
