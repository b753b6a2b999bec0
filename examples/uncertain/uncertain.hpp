// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What is certain of a distance if a stereo camera is noisy, its pose is not exact, things move, and joints have play.

#include <clearance/make_model.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

// [formula]
/// 2 mm for each metre that a point is away, and nothing is known beyond 4 m.
struct my_noise {
  CLEARANCE_HD clearance::real operator()(std::size_t, clearance::vec3 p) const {
    const clearance::real away = clearance::length(p);
    return away < 4 ? clearance::product(0.002f, away) : clearance::infinity;
  }
};
static_assert(clearance::sensor_noise<my_noise>);
// [formula]

/// 0 if the wall is nearer by its noise than the box in front of it.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links{{{{0, 0, 0}, 0.1f}}, {{{0, 0, 0}, 0.1f}}};
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  poses[0].translation() << -0.1, 0, 0.55, poses[1].translation() << 0.3, 0, 1.4;
  std::vector<std::uint16_t> depth(64 * 48, 1000);  // mm: a box 1 m away, and beside it a wall
  for (std::size_t i = 0; i < depth.size(); ++i)
    if (i % 64 >= 32) depth[i] = 2000;

  // [ask]
  const clearance::depth_image image(depth.data(), 64, 48, clearance::intrinsics{60, 60, 31.5, 23.5});
  const clearance::uncertain seen(image,
                                  clearance::stereo_noise{.focal_length = 60, .baseline = 0.1f, .disparity = 0.1f},
                                  {.shift = 0.005, .turn = 0.002, .max_speed = 1.6, .age = 0.03});
  const clearance::certain_distance asked{.parts = {{.joints = 0.002}, {.joints = 0.004, .delay = 0.01}}};
  const auto r = clearance::ask(on, arm, poses, clearance::placed{seen}, asked);
  std::printf("%.3f m as measured, from link %u; certainly %.3f m, from link %u\n", double(r.nominal.distance),
              r.nominal.part, double(r.lower), r.certain.part);
  const clearance::uncertainty_shares& s = r.certain.shares;
  std::printf("noise %.3f, calibration %.3f, time %.3f, joints %.3f, delay %.3f, gap %.3f\n", s.noise, s.calibration,
              s.time, s.joints, s.delay, s.gap);
  // [ask]
  const bool by_noise = r.nominal.part == 0 && r.certain.part == 1 && s.noise > 0.1;
  const bool less = std::abs(r.certain.distance - s.sum() - r.lower) < 1e-5 && r.lower < r.nominal.lower;
  const clearance::uncertain other(image, my_noise{});
  const auto mine = clearance::ask(on, arm, poses, clearance::placed{other}, clearance::certain_distance{});
  return by_noise && less && std::abs(mine.certain.shares.noise - 0.002) < 0.0005 ? 0 : 1;
}
