// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A box stands between a camera and an arm. How far is the arm from what the box hides?

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/unseen.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the arm is as far from the box's shadow as geometry says, and its own shadow is told apart.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(1);
  for (int i = 0; i < 20; ++i) links[0].push_back({{0.02f * float(i), 0, 0}, 0.04f});
  std::vector<Eigen::Isometry3d> poses(1, Eigen::Isometry3d::Identity());
  poses[0].translation() << 0.1, 0, 1.2;   // in front of the wall, to the right of the box
  std::vector<float> depth(160 * 120, 2);  // a wall
  const clearance::intrinsics camera{150, 150, 79.5, 59.5};
  for (int v = 40; v < 80; ++v)
    for (int u = 40; u < 60; ++u) depth[std::size_t(160 * v + u)] = 0.8f;  // the box, on the left
  for (int v = 56; v < 64; ++v)
    for (int u = 90; u < 135; ++u) depth[std::size_t(160 * v + u)] = 1.16f;  // the arm itself
  const Eigen::Isometry3d camera_pose = Eigen::Isometry3d::Identity();

  // [unseen]
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  const clearance::placed image{clearance::depth_image(depth.data(), 160, 120, camera), camera_pose};
  const auto own = clearance::ask(on, arm, poses, image, clearance::self_filter{.padding = {0.03}});

  const clearance::unseen question{.room = {.nearest = 0.3f, .farthest = 3}, .labels = own.labels};
  const clearance::unseen_result r = clearance::ask(on, arm, poses, image, question);
  std::printf("%s: at least %.3f m from what is hidden, behind pixel %u, %u; %.0f %% of the arm is out of view\n",
              clearance::to_string(r.all.state), double(r.all.lower), r.all.point % 160, r.all.point / 160,
              100 * double(r.parts[0].out_of_view));
  std::printf("its own shadow, of %llu pixels, is %.3f m away\n", (unsigned long long)r.own_shadow.valid,
              double(r.own_shadow.distance));
  // [unseen]
  const bool by_the_box = r.all.point % 160 == 59 && r.all.point / 160 >= 40 && r.all.point / 160 < 80;
  return r.all.state == clearance::state::free && by_the_box && r.all.lower > 0.1f && r.all.distance < 0.3f &&
                 r.own_shadow.distance < 0.01f && r.own_shadow.valid == 8 * 45 && r.parts[0].out_of_view == 0
             ? 0
             : 1;
}
