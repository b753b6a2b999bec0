// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Questions about pairs: which points are near, to whom they belong, and which confirm one another.

#include "robot_on.hpp"

#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/zones.hpp>

template <class Backend>
clearance::zones_result robot_on_backend<Backend>::zones(poses_of poses, const clearance::zones& options) {
  return with_clouds([&](const auto& clouds) {
    return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, clouds, options); });
  });
}

template <class Backend>
clearance::self_filter_result robot_on_backend<Backend>::own_points(poses_of poses, double padding) {
  return with_usual_trees([&](const auto& trees) {
    return clearance::ask(on_, trees, poses, clouds_, clearance::self_filter{.padding = {padding}});
  });
}

template <class Backend>
clearance::supported_distance robot_on_backend<Backend>::supported(poses_of poses,
                                                                   const clearance::min_distance_supported& options) {
  return with_usual_trees([&](const auto& trees) { return clearance::ask(on_, trees, poses, clouds_, options); });
}

template <class Backend>
clearance::nearest_k_result robot_on_backend<Backend>::nearest(poses_of poses, std::size_t k, double d_max) {
  return with_usual_trees([&](const auto& trees) {
    return clearance::ask(on_, trees, poses, clouds_, clearance::nearest_k{.k = k, .d_max = clearance::real(d_max)});
  });
}
