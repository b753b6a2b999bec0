// SPDX-License-Identifier: BSD-3-Clause
// A second opinion from FCL about balls: robots of spheres before one another, and one before itself, by its broad
// phase.
#include "clearance/itself.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/distance.h>

namespace fcl_balls_test {

using namespace testing;
using clearance::host, clearance::part_pairs;

namespace {

/// A link's spheres in FCL's broad phase.
class fcl_link {
 public:
  fcl_link(const std::vector<inner_sphere>& spheres, const Eigen::Isometry3d& pose) {
    for (const inner_sphere& s : spheres) {
      objects_.push_back(
          std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Sphered>(s.radius), Eigen::Matrix3d::Identity(),
                                                  pose * Eigen::Vector3d(s.center.x, s.center.y, s.center.z)));
      tree_.registerObject(objects_.back().get());
    }
    tree_.setup();
  }
  double distance(fcl_link& other) {
    fcl::DefaultDistanceData<double> data;
    tree_.distance(&other.tree_, &data, fcl::DefaultDistanceFunction);
    return data.result.min_distance;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd tree_;
};

}  // namespace

TEST_CASE("Robots of spheres are as far from one another and from themselves as FCL's broad phase says") {
  verdict v;
  dice d(91);
  std::size_t apart = 0;
  for (int round = 0; round < 20; ++round) {
    const chain_of_spheres robot(d, 0, 1);
    const auto model = robot.model();
    const auto poses = robot.poses(d);
    std::vector<std::unique_ptr<fcl_link>> links;
    for (std::size_t k = 0; k < poses.size(); ++k)
      links.push_back(std::make_unique<fcl_link>(robot.links[k], poses[k]));
    const auto itself = self_distance(host{}, model, poses, part_pairs(poses.size()));
    for (const clearance::pair_clearance& pair : itself.pairs) {
      const double is = links[pair.a]->distance(*links[pair.b]);
      if (!(pair.distance > 1e-4)) continue;  // how deep spheres overlap is not its business
      v.require(std::abs(pair.distance - is) < 2e-6 && pair.lower <= is, "links", pair.a, " and", pair.b, " are", is,
                " apart, and not", pair.distance);
      ++apart;
    }
    std::vector<Eigen::Isometry3d> there = robot.poses(d);
    for (auto& pose : there) pose = shifted(0.3, 1, 0) * pose;
    const auto r = ask(host{}, model, poses, as_balls(model, there), clearance::min_distance{});
    double is = clearance::infinity;
    for (std::size_t b = 0; b < there.size(); ++b) {
      fcl_link other(robot.links[b], there[b]);
      for (auto& link : links) is = std::min(is, link->distance(other));
    }
    if (r.distance > 1e-4)
      v.require(std::abs(r.distance - is) < 2e-6 && r.lower <= is && is <= r.upper, "robots are", is, " apart, and not",
                r.distance);
  }
  CHECK(apart > 50);
}

}  // namespace fcl_balls_test
