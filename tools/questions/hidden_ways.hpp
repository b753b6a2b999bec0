// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How near the robot comes, on its ways, to what its cameras hide.

#include "unseen.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/motion_clearance.hpp>

/// One way, where `ask(poses)` is `unseen` and `images` are what it is about.
template <class Ask, class Images>
clearance::motion_clearance_result hidden_way(const Ask& ask, std::span<const clearance::part_facts> facts,
                                              const clearance::io::joint_motion& way, const Images& images,
                                              const clearance::motion_clearance_options& options) {
  using clearance::state;
  bool reaches = false, nothing_hides = false;
  const auto least = [&](poses_of poses) {
    const clearance::unseen_result& found = ask(poses);
    reaches = reaches || found.all.state == state::unknown;
    nothing_hides = found.all.state == state::free && found.all.part == clearance::none;
    clearance::min_distance_per_part_result made;
    made.all = found.all;
    for (const clearance::unseen_part& its : found.parts) {
      made.parts.emplace_back();
      made.parts.back().distance = its.lower;  // what is certain, parts' gaps and radii taken off
    }
    return made;
  };
  auto found = clearance::detail::over_motion(least, facts, way, images, options);
  if (nothing_hides) {  // whatever the robot does
    found.state = state::free, found.lower = clearance::infinity, found.settled = true;
    return found;
  }
  if (found.state == state::collision) found.state = state::unknown;  // nobody knows what is there
  if (found.state == state::possible && reaches) found.state = state::unknown;
  return found;
}

template <class Backend>
std::vector<clearance::motion_clearance_result> robot_on_backend<Backend>::hidden_ways(
    std::span<const clearance::io::joint_motion> ways, const clearance::motion_clearance_options& options,
    const clearance::unseen& room) {
  return with_images(false, [&](const auto& images) {
    return with_usual_trees([&](const auto& trees) {
      clearance::query asked(on_, trees, room);
      const auto its = trees.view().facts;
      std::vector<clearance::part_facts> facts(its.begin(), its.end());
      for (clearance::part_facts& part : facts)  // `unseen` has taken gaps and tolerances off
        part = {.center = part.center, .radius = clearance::rounded_up(clearance::solid_radius(part))};
      std::vector<clearance::motion_clearance_result> all;
      const auto ask = [&](poses_of poses) -> decltype(auto) { return asked(poses, images, room); };
      for (const clearance::io::joint_motion& way : ways) all.push_back(hidden_way(ask, facts, way, images, options));
      return all;
    });
  });
}
