// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An answer in time: what is known of a large cloud when the control cycle is over, and how much of it that is about.

#include <clearance/deadline.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if every answer holds for all points, seen or not, and the patient one is the whole one.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 40; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0, 0.3f * float(k)}, 0.04f});
  const std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
  std::vector<clearance::vec3> hall;  // 3 million points, 5 m away; near the last ones something is 10 cm away
  for (int i = 0; i < 3000000; ++i) hall.push_back({0.005f * float(i % 2000), 5, 0.005f * float(i / 2000)});
  for (int i = 0; i < 20; ++i) hall.push_back({0.4f, 0.14f, 0.001f * float(i)});

  // [deadline]
  using namespace std::chrono_literals;
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  const auto all = clearance::ask(on, arm, poses, hall, clearance::min_distance{});
  bool right = true;
  for (const std::chrono::duration<double> deadline : {0us, 1000us, 5000us, 10000000us}) {
    const auto [r, unseen] = clearance::ask_by(on, arm, poses, hall, deadline, clearance::min_distance{});
    std::printf("%8.1f ms: %3.0f %% of the points, %s, %.3f m; certainly at least %.3f m\n", 1e3 * deadline.count(),
                100 * double(r.seen) / double(r.seen + unseen), to_string(r.state), double(r.distance),
                double(r.lower));
    right = right && r.lower <= all.lower && all.upper <= r.upper && (unseen == 0 || !(r.lower > 0));
  }
  // [deadline]
  const auto [patient, unseen] = clearance::ask_by(on, arm, poses, hall, 10s, clearance::min_distance{});
  return right && unseen == 0 && patient.distance == all.distance && patient.point == all.point &&
                 patient.lower == all.lower
             ? 0
             : 1;
}
