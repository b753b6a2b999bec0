// SPDX-License-Identifier: BSD-3-Clause
// On a device a robot is as far from itself and from another robot as on the host, to the bit; spheres stay there.
#include "clearance/itself.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/same_answer.hpp"

#include <clearance/device.cuh>
#include <clearance/self_distances.hpp>

namespace self_distance_device_test {

using namespace testing;
using clearance::device, clearance::host, clearance::part_pairs, clearance::placed, clearance::point_span,
    clearance::self_queries, clearance::self_query;

TEST_CASE("On a device a robot is as far from itself as on the host, frame after frame and in many configurations") {
  verdict v;
  dice d(81);
  const device gpu;
  for (const double gap : {0.0, 0.02}) {
    const chain_of_spheres robot(d, gap, 0.6);
    part_pairs pairs(robot.links.size());
    pairs.remove_neighbours(robot.parents());
    const auto on_host = robot.model();
    const auto there = on_host.on(gpu);
    self_query here(host{}, on_host, pairs);
    self_query ask(gpu, there, pairs);
    std::vector<Eigen::Isometry3d> many;
    for (int frame = 0; frame < 50; ++frame) {
      const auto poses = robot.poses(d);
      v.require(same_self(here(poses), ask(poses)), "frame", frame);
      many.insert(many.end(), poses.begin(), poses.end());
    }
    const auto expected = self_queries(host{}, on_host, pairs)(many), all = self_queries(gpu, there, pairs)(many);
    for (std::size_t c = 0; c < all.size(); ++c)
      v.require(
          same_pair(all[c], expected[c]) && all[c].state == expected[c].state && all[c].upper == expected[c].upper,
          "configuration", c);
  }
}

TEST_CASE("On a device another robot is an obstacle where its spheres are, beside a cloud, as on the host") {
  verdict v;
  dice d(82);
  const device gpu;
  const chain_of_spheres one(d, 0.01, 0.5), other(d, 0.02, 0.5);
  const auto its = one.model(), obstacle = other.model();
  const auto its_there = its.on(gpu), obstacle_there = obstacle.on(gpu);
  const auto cloud = d.points(3000, 2);
  const auto cloud_there = gpu.copy_in(std::span<const vec3>(cloud));
  const placed seen{point_span(cloud)}, seen_there{point_span(cloud_there.data(), cloud.size())};
  clearance::query ask_it(gpu, its_there, clearance::min_distance{});
  clearance::query each(gpu, its_there, clearance::min_distance_per_part{});
  for (int frame = 0; frame < 20; ++frame) {
    const auto poses = one.poses(d);
    auto there = other.poses(d);
    for (auto& pose : there) pose = shifted(0.9, 0.1 * frame, 0) * pose;
    const std::tuple here(seen, as_balls(obstacle, there));
    const std::tuple on_gpu(seen_there, as_balls(obstacle_there, there));
    v.require(same_answer(ask(host{}, its, poses, here, clearance::min_distance{}),
                          clearance::min_distance_result(ask_it(poses, on_gpu))),
              "frame", frame);
    v.require(same_answer(ask(host{}, its, poses, here, clearance::min_distance_per_part{}),
                          clearance::min_distance_per_part_result(each(poses, here))),
              "frame", frame, ", from the host's memory");
  }
}

}  // namespace self_distance_device_test
