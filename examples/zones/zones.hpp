// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Stop, slow down, warn: zones around the links of an arm, as safety engineers and Nav2's collision monitor know them.
// And approach: as slow as leaves time before a collision.

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/separation.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

/// 0 if the arm stops, slows down and goes on where it should.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(2);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 20; ++i) links[std::size_t(k)].push_back({{0.02f * float(i), 0, 0}, 0.04f});
  std::vector<clearance::vec3> person;  // a patch of 6 cm, 1.2 m away
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 20; ++j) person.push_back({1.2f, 0.003f * float(i), 0.003f * float(j)});

  // [zones]
  const auto arm = clearance::make_model<clearance::sphere>(links).on(on);
  const clearance::zones zones{.thresholds = {0.1, 0.3, 0.6}, .min_points = 5};  // stop, slow down, warn
  clearance::query ask(on, arm, zones);  // once; a single call is clearance::ask(on, arm, poses, person, zones)
  std::size_t wrong = 0, expected = 3;
  for (const double reached : {0.0, 0.3, 0.5, 0.7}) {
    std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
    poses[1].translation().x() = reached;
    const auto seen = ask(poses, person);
    const char* const what[] = {"stop", "slow down", "warn", "go on"};
    std::printf("%.1f m: %s; %llu points in the warning zone of the last link, the nearest %.2f m away\n", reached,
                what[seen.innermost()], static_cast<unsigned long long>(seen.of(1, 2).points),
                double(seen.of(1, 2).nearest));
    // [zones]
    wrong += seen.innermost() != expected-- ||
             clearance::ask(on, arm, poses, person, zones).of(1, 2).points != seen.of(1, 2).points;
  }

  for (const double x : {0.5, -0.5}) {
    std::vector<Eigen::Isometry3d> poses(2, Eigen::Isometry3d::Identity());
    poses[1].translation().x() = 0.3;
    // [approach]
    const std::vector<Eigen::Vector3d> velocity{{0, 0, 0},
                                                {x, 0, 0}};  // of each link, as commanded (m/s); neither turns
    const double time_before_collision = 2;                  // seconds that have to remain
    const auto [least, minima] = clearance::ask(on, arm, poses, person, clearance::min_distance_per_part{});
    double speed = least.lower > 0 ? 1 : 0,
           fastest = 0;  // the share of the commanded speed, 0 if nothing is known; and how fast a gap closes
    for (const auto& near : clearance::ask(on, arm, poses, person, clearance::part_witnesses{minima})) {
      if (near.part == clearance::none) continue;
      const auto closing =
          clearance::approach_speed(near, velocity[near.part], Eigen::Vector3d::Zero(), poses[near.part].translation());
      fastest = std::max(fastest, closing.value_or(0));  // without a direction it touches, or is inside: `lower` is 0
    }
    if (fastest > 0)
      speed = std::min(speed, double(least.lower) / (time_before_collision * fastest));  // moving away is not slowed
    std::printf("%.2f m away, at %+.1f m/s: %.0f %% of that\n", double(least.distance), x, 100 * speed);
    // [approach]
    wrong += std::abs(speed - (x > 0 ? 0.48 : 1.0)) > 1e-4;

    // [separation]
    const double wanted = clearance::protective_separation({.human_speed = 1.6,
                                                            .robot_speed = fastest,
                                                            .reaction_time = 0.1,
                                                            .stopping_time = 0.1,
                                                            .stopping_distance = 0.03,
                                                            .intrusion = 0.05,
                                                            .human_uncertainty = 0.03,
                                                            .robot_uncertainty = 0.005});
    std::printf("%.3f m are wanted: %s\n", wanted, least.lower > wanted ? "go on" : "stop");
    // [separation]
    wrong += (least.lower > wanted) != (x < 0);
  }
  return int(wrong);
}
