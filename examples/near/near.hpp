// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Is any point closer than a margin, and which points are?

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if both say what a plain loop says.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0.3f * float(k), 0}, 0.04f});
  std::vector<clearance::vec3> shelf;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 50; ++j) shelf.push_back({0.005f * float(i), 0.44f, 0.01f * float(j) - 0.25f});
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());

  // [near]
  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  const auto touched = clearance::ask(on, robot, poses, shelf, clearance::in_collision{{0.12}});  // metres
  std::printf("closer than 12 cm: %s, point %u is near link %u\n", to_string(touched.state), touched.point,
              touched.part);

  const auto near = clearance::ask(on, robot, poses, shelf, clearance::within{{0.12}});
  for (std::size_t k = 0; k < links.size(); ++k)
    std::printf("link %zu: %zu points within 12 cm\n", k, near.offsets[k + 1] - near.offsets[k]);

  clearance::query ask(on, robot, clearance::in_collision{{0.12}});  // for every frame: it keeps its memory
  const auto again = ask(poses, shelf);
  // [near]

  std::size_t expected = 0, first = shelf.size();
  for (std::size_t i = 0; i < shelf.size(); ++i)
    for (const auto& link : links) {
      clearance::real least = clearance::infinity;
      for (const auto& s : link) least = std::min(least, s.distance(shelf[i]));
      if (least > 0.12f) continue;
      ++expected;
      first = std::min(first, i);
    }
  const bool same = touched.state == clearance::state::collision && touched.point == first && again.point == first;
  return near.pairs.size() == expected && expected > 0 && same ? 0 : 1;
}
