// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Builds trees from bodies.

#include "robot_on.hpp"

#include <clearance/io/field_cache.hpp>
#include <clearance/io/robot_bodies.hpp>
#include <clearance/make_model.hpp>

#include <ranges>

/// The trees of all bodies, in host memory.
template <class V>
auto trees_of_spheres(const std::vector<body>& bodies) {
  return clearance::make_model<V>(bodies | std::views::transform(&body::packed), [&](std::size_t k) {
    return clearance::part_options{.tolerance = bodies[k].tolerance};
  });
}
template <class V>
auto trees_of_triangles(const std::vector<body>& bodies) {
  return clearance::make_model<V>(bodies | std::views::transform(&body::closed), [&](std::size_t k) {
    return clearance::part_options{.tolerance = bodies[k].tolerance};
  });
}

template <class Backend>
auto robot_on_backend<Backend>::usual_trees() -> const trees& {
  if (trees_.index() != 0) return trees_;
  const auto maybe_fielded = [this](const auto& make) {
    return moved([&](const std::vector<body>& bodies) {
      auto trees = make(bodies);
      if (asked_.fields == field_use::none) return trees;
      const clearance::io::field_cache cache(asked_.cache);
      auto made = asked_.fields == field_use::always
                      ? clearance::io::with_fields_cached(on_, std::move(trees), {}, cache)
                      : clearance::io::with_kept_fields(std::move(trees), {}, cache);
      without_field = std::move(made.without);
      fields = made.model.fields().size(), fields_cached = fields == 0 ? 0 : made.found;
      return std::move(made.model);
    });
  };
  if (asked_.model == model_kind::spheres)
    trees_.template emplace<sphere_trees>(maybe_fielded(trees_of_spheres<clearance::sphere>));
  else
    trees_.template emplace<triangle_trees>(maybe_fielded(trees_of_triangles<clearance::obb>));
  return trees_;
}
