// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is every point of a cloud from a robot, and from which of its links?

#include <clearance/make_model.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/volume/sphere.hpp>

#include <algorithm>
#include <cstdio>

/// 0 if every distance is that of a plain loop over all spheres.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 40; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0.1f * float(k), 0}, 0.04f});
  std::vector<clearance::vec3> wall;
  for (int i = 0; i < 100; ++i)
    for (int j = 0; j < 100; ++j)
      wall.push_back({0.02f * float(i) - 0.5f, 0.3f + 0.001f * float(i % 5), 0.02f * float(j) - 1});
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());

  // [distances]
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const auto all = clearance::ask(on, robot, poses, wall, clearance::distances{.d_max = 0.5, .which = true});
  const auto near = std::ranges::count_if(
      all.distance, [&](clearance::real d) { return d <= 0.5f && !(all.certain.lower(d) > 0.25f); });
  const auto first = std::size_t(std::ranges::min_element(all.distance) - all.distance.begin());
  std::printf("%zd of %zu points are perhaps nearer than 25 cm; the nearest is %.1f cm from link %u\n",
              std::ptrdiff_t(near), wall.size(), 100.0 * all.distance[first], all.part[first]);
  // [distances]

  // [parts]
  const auto each =
      clearance::ask(on, robot, poses, wall, clearance::distances_per_part{});  // of every link to every point
  std::printf("that point is %.1f cm from link 0 and %.1f cm from link 1\n", 100.0 * each.of(0)[first],
              100.0 * each.of(1)[first]);
  // [parts]

  // [cells]
  const auto listed = clearance::with_cells(on, clearance::make_model<clearance::sphere>(links), {.reach = 2});
  for (const std::string& why_not : listed.without)
    if (!why_not.empty()) std::printf("no cells: %s\n", why_not.c_str());
  const auto there = listed.model.on(on);
  clearance::query sooner(on, there, clearance::distances{});
  // [cells]
  if (sooner(poses, wall).distance != clearance::ask(on, robot, poses, wall, clearance::distances{}).distance ||
      listed.model.cells().empty())
    return 1;

  for (std::size_t i = 0; i < wall.size(); ++i) {
    if (all.distance[i] <= 0.5f && all.distance[i] != std::min(each.of(0)[i], each.of(1)[i])) return 1;
    clearance::real least = clearance::infinity;
    for (const auto& link : links)
      for (const auto& s : link) least = std::min(least, s.distance(wall[i]));
    if (all.distance[i] != (least <= 0.5f ? least : clearance::infinity)) return 1;
  }
  return near > 0 && near < std::ptrdiff_t(wall.size()) ? 0 : 1;
}
