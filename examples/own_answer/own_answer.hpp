// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An answer of one's own: for each part of a robot, how many points are nearer than 5, 10 and 20 cm.

#include <clearance/ground/ordered.hpp>
#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/volume/sphere.hpp>

#include <cstdio>

// [answer]
struct crowding {
  static constexpr clearance::real limits[3] = {0.05f, 0.1f, 0.2f};
  unsigned long long* counts;  ///< Three per part, in memory that the backend writes.

  /// Farther pairs do not matter.
  CLEARANCE_HD clearance::real reach(std::uint32_t) const { return 0.2f; }

  /// Every point this near to some part comes here once per part, from any thread.
  CLEARANCE_HD void take(const clearance::pair_distance& pair) const {
    for (int zone = 0; zone < 3; ++zone)
      if (pair.distance < (zone == 0 ? 0.05f : zone == 1 ? 0.1f : 0.2f))
        clearance::add_to(counts + 3 * pair.part + zone, 1);
  }
};

static_assert(clearance::explain_answer<crowding>());
// [answer]

/// 0 if the counts are those of two plain loops.
template <clearance::backend Backend>
int example(const Backend& on) {
  std::vector<std::vector<clearance::inner_sphere>> links(3);
  std::vector<Eigen::Isometry3d> poses(3, Eigen::Isometry3d::Identity());
  for (std::size_t k = 0; k < links.size(); ++k) {
    for (int i = 0; i < 50; ++i) links[k].push_back({{0.01f * i, 0.02f * std::sin(0.3f * i), 0}, 0.03f});
    poses[k].translation() << 0.1 * double(k), 0.25 * double(k), 0;
  }
  std::vector<clearance::vec3> cloud;
  for (int i = 0; i < 20000; ++i)
    cloud.push_back({0.0007f * float(i % 1000), 0.05f * float(i / 1000), 0.01f * float(i % 11)});

  const auto robot = clearance::make_model<clearance::sphere>(links).on(on);
  // [ask]
  const auto counts =
      on.copy_in(std::span<const unsigned long long>(std::vector<unsigned long long>(3 * robot.size())));
  const crowding answer{const_cast<unsigned long long*>(counts.data())};
  const clearance::point_counts seen = clearance::ask(on, robot, poses, cloud, clearance::collect{answer});
  const auto near = on.copy_out(counts);
  // [ask]

  std::vector<unsigned long long> expected(near.size());
  for (const auto& p : cloud)
    for (std::size_t k = 0; k < links.size(); ++k) {
      const clearance::vec3 q = clearance::to_floats(poses[k].inverse())(p);
      clearance::real least = clearance::infinity;
      for (const auto& s : links[k]) least = std::min(least, s.distance(q));
      for (int zone = 0; zone < 3; ++zone) expected[3 * k + zone] += least < crowding::limits[zone];
    }
  for (std::size_t k = 0; k < links.size(); ++k)
    std::printf("part %zu: %llu points nearer than 5 cm, %llu than 10, %llu than 20\n", k, near[3 * k], near[3 * k + 1],
                near[3 * k + 2]);
  return near == expected && seen.valid == cloud.size() ? 0 : 1;
}
