// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "robot_on.hpp"

#include <clearance/questions/distances.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/signed_distances.hpp>

#include <stdexcept>

template <class Backend>
clearance::point_distances robot_on_backend<Backend>::distances(poses_of poses, double d_max, bool is_signed) {
  const double most = clearance::real(d_max);
  return with_usual_trees([&](const auto& trees) {
    if (!is_signed)
      return clearance::ask(on_, trees, poses, clouds_, clearance::distances{.d_max = most, .which = true});
    if constexpr (clearance::scan::has_interior<typename decltype(clearance::view_of(trees))::part_type>)
      return clearance::ask(on_, trees, poses, clouds_, clearance::signed_distances{.d_max = most, .which = true});
    else
      throw std::logic_error("distances to spheres are signed already");
  });
}

template <class Backend>
std::vector<clearance::part_witness> robot_on_backend<Backend>::witnesses(
    poses_of poses, std::span<const clearance::part_minimum> minima) {
  return with_usual_trees(
      [&](const auto& trees) { return clearance::ask(on_, trees, poses, clouds_, clearance::part_witnesses{minima}); });
}
