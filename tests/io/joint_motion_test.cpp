// SPDX-License-Identifier: BSD-3-Clause
// Motions by joints: how far a link's points get, and the clearance on the way, compared with dense samples.
#include "io/random_tree.hpp"
#include "io/robot_folder.hpp"
#include "support/laws.hpp"
#include "support/scenes.hpp"

#include <clearance/io/joint_motion.hpp>
#include <clearance/make_model.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/volume/sphere.hpp>

#include <numbers>

namespace joint_motion_test {

using namespace testing;
using namespace clearance::io;
using clearance::host, clearance::motion_clearance, clearance::part_travel, clearance::state;

namespace {

/// Another configuration, `size` away at most in each value.
std::vector<double> other(dice& d, std::vector<double> q, double size) {
  for (double& x : q) x += d.uniform(-size, size);
  return q;
}

std::vector<std::size_t> all_links(const kinematic_tree& tree) {
  std::vector<std::size_t> links;
  for (std::size_t k = 0; k < tree.links().size(); ++k) links.push_back(k);
  return links;
}

}  // namespace

TEST_CASE("A joint motion's bound holds for every point of a link at every time") {
  verdict v;
  dice d(31);
  double tightest = 0;
  std::size_t wide = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const auto [tree, from] = random_tree(d, 2 + d.below(9), trial % 3 == 0 ? 0.01 : 0.4);
    const auto to = other(d, from, trial % 4 == 0 ? 8 : 0.7);
    const joint_motion motion(tree, all_links(tree), from, to, {}, d.pose(1));
    std::vector<clearance::part_facts> parts;
    for (std::size_t k = 0; k < tree.links().size(); ++k)
      parts.push_back({d.point(0.3), d.number(0, 0.2), d.number(0, 0.05), d.number(0, 0.05)});
    const double t = d.uniform(0, 1);
    const auto now = motion.at(t, parts);
    for (int step = 0; step < 30; ++step) {
      const double h = std::pow(10, d.uniform(-4, 0)), when = std::clamp(t + (step % 2 == 0 ? h : -h), 0.0, 1.0);
      const auto then = motion.at(when, parts);
      for (std::size_t k = 0; k < parts.size(); ++k) {
        const vec3 n = d.direction();
        const Eigen::Vector3d p = clearance::center_of(parts[k]) +
                                  clearance::solid_radius(parts[k]) * Eigen::Vector3d(n.x, n.y, n.z).normalized();
        const double moved = (now.poses[k] * p - then.poses[k] * p).norm(),
                     most = now.travels[k].within(std::abs(when - t));
        v.require(moved <= most, "link", k, " moves", moved, " of at most", most);
        if (most > 1e-3) tightest = std::max(tightest, moved / most);
        wide += most > 3;
      }
    }
  }
  CHECK(tightest > 0.95);
  CHECK(wide > 10);
}

TEST_CASE("No time of a joint motion has less than its clearance") {
  verdict v;
  dice d(62);
  std::size_t free = 0, with_mimics = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const auto [tree, from] = random_tree(d, 7, 0.3);
    const auto to = other(d, from, trial % 3 == 0 ? 3 : 0.5);
    std::vector<std::vector<inner_sphere>> bodies;
    for (std::size_t k = 0; k < tree.links().size(); ++k) bodies.push_back(random_spheres(d, 8, 0.1, 0.05));
    const auto model = clearance::make_model<clearance::sphere>(bodies);
    const auto points = d.points(30, 2);
    const joint_motion motion(tree, all_links(tree), from, to);
    const auto r = motion_clearance(host{}, model, motion, points, {.tolerance = 0.01, .most_queries = 20000});
    clearance::query query(host{}, model, clearance::min_distance{});
    double least = clearance::infinity;
    for (int i = 0; i <= 1000; ++i) {
      std::vector<double> q;
      for (std::size_t j = 0; j < from.size(); ++j) q.push_back(from[j] + i / 1000.0 * (to[j] - from[j]));
      least = std::min(least, double(query(tree.link_poses(q), points).distance));
    }
    least = std::max(0.0, least);
    v.require(double(r.lower) <= least, "trial", trial, ": lower", r.lower, " but at some time", least);
    v.require(r.settled && double(r.lower) >= least - 0.0101, "trial", trial, ": lower", r.lower, " of", least,
              " after", r.queries);
    v.require(r.state == (r.lower > 0    ? state::free
                          : r.upper <= 0 ? state::collision
                                         : state::possible),
              "trial", trial, ": the state");
    free += r.state == state::free;
    for (const auto& joint : tree.joints()) with_mimics += r.state == state::free && joint.follows;
  }
  CHECK(free > 5);
  CHECK(with_mimics > 5);
}

TEST_CASE("A hinge, a slide and one that follows move their links as far as they do") {
  std::vector<joint> joints(3);
  const char* const names[] = {"hinge", "slide", "double"};
  for (std::size_t k = 0; k < 3; ++k) {
    joints[k].name = names[k], joints[k].parent = "l" + std::to_string(k),
    joints[k].child = "l" + std::to_string(k + 1);
    joints[k].kind = k == 1 ? joint_kind::prismatic : joint_kind::revolute;
    joints[k].axis = Eigen::Vector3d::UnitZ();
  }
  joints[1].axis = Eigen::Vector3d::UnitX();
  joints[2].follows = mimic{"slide", 2, 0.5};
  const kinematic_tree tree({"l0", "l1", "l2", "l3"}, joints);
  const std::vector<clearance::part_facts> parts{{{3, 4, 0}, 1}};
  const auto travel = [&](std::size_t link, std::vector<double> from, std::vector<double> to) {
    return joint_motion(tree, {link}, from, to).at(0.5, parts).travels[0];
  };
  CHECK(travel(0, {0, 0}, {1, 1}).within(1) < 1e-12);
  CHECK(travel(1, {0, 0}, {0.5, 1}).within(1) == Approx(0.5 * 6));         // 5 m to its middle, and its radius
  CHECK(travel(2, {1, 0}, {1, 2}).within(0.5) == Approx(1));               // it slides by 2 m in all
  CHECK(travel(2, {0, 1}, {1, 1}).speed == Approx(std::hypot(4, 4) + 1));  // 1 m farther from the hinge
  CHECK(travel(2, {0, -1}, {1, 1}).most == Approx(1 * (6 + 1) + 2));
  CHECK(travel(3, {0, 0}, {0, 0.5}).most == Approx(1 * 6 + 0.5));  // turns by twice what the slide does
}

TEST_CASE("An arm that unfolds is faster soon than it is now") {
  verdict v;
  std::vector<joint> joints(3);
  for (std::size_t k = 0; k < 3; ++k) {
    joints[k].name = "j" + std::to_string(k), joints[k].parent = "l" + std::to_string(k),
    joints[k].child = "l" + std::to_string(k + 1);
    joints[k].kind = k == 2 ? joint_kind::prismatic : joint_kind::revolute;
    joints[k].axis = k == 2 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitZ();
  }
  joints[1].origin.translation().x() = 1;
  joints[2].follows = mimic{"j1", 0, 0.5};  // half a metre out, always
  const kinematic_tree tree({"l0", "l1", "l2", "l3"}, joints);
  const std::vector<clearance::part_facts> parts{{{0.5f, 0, 0}, 0}};
  // Folded, the link's point is on the first joint's axis, and that turns it nowhere.
  const joint_motion unfold(tree, {3}, std::vector{0.0, -std::numbers::pi}, std::vector{3.0, 0.0});
  const auto now = unfold.at(0, parts);
  CHECK(now.travels[0].speed == Approx(std::numbers::pi));
  CHECK(now.travels[0].most == Approx(3 * 2 + std::numbers::pi));
  double tightest = 0;
  for (double h = 1e-3; h <= 1; h += 1e-3) {
    const Eigen::Vector3d middle(0.5, 0, 0);
    const double fastest =
        (unfold.at(h, parts).poses[0] * middle - unfold.at(h - 1e-6, parts).poses[0] * middle).norm() / 1e-6;
    const part_travel& t = now.travels[0];
    v.require(fastest <= std::min(t.most, t.speed + t.growth * h) * (1 + 1e-6), "at", h, " it moves at", fastest);
    tightest = std::max(tightest, fastest / std::min(t.most, t.speed + t.growth * h));
  }
  CHECK(tightest > 0.95);
  const joint_motion stretch(tree, {3}, std::vector{0.0, 0.0}, std::vector{3.0, 0.0});
  CHECK(stretch.at(0, parts).travels[0].most == Approx(3 * 2));
  CHECK(stretch.at(0, parts).travels[0].speed == Approx(3 * 2));
}

TEST_CASE("Joint motions refuse what is no configuration, link or base") {
  dice d(6);
  const auto [tree, q] = random_tree(d, 5, 0.3);
  const auto refusal = [&, &tree = tree, &q = q](std::vector<std::size_t> links, std::vector<double> to,
                                                 joint_options options, const Eigen::Isometry3d& base) {
    return sentence<std::invalid_argument>([&] { joint_motion(tree, links, q, to, options, base); });
  };
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  auto bad = q;
  CHECK(refusal({0, 4}, q, {}, here).empty());
  CHECK(says(refusal({0, 5}, q, {}, here), "none of number 5"));
  bad[0] = std::nan("");
  CHECK(says(refusal({0}, bad, {.ignore_limits = true}, here), "not finite"));
  bad.pop_back();
  CHECK(says(refusal({0}, bad, {}, here), "movable joints"));
  Eigen::Isometry3d scaled = here;
  scaled.linear() *= 2;
  CHECK(says(refusal({0}, q, {}, scaled), "the base"));
  const joint_motion motion(tree, {0, 1}, q, q);
  CHECK(
      says(sentence<std::invalid_argument>([&] { motion.at(0.5, std::vector<clearance::part_facts>(3)); }), "3 parts"));

  joint limited;
  limited.name = "j", limited.parent = "a", limited.child = "b", limited.kind = joint_kind::revolute,
  limited.lower = -1, limited.upper = 0.7;
  const kinematic_tree narrow({"a", "b"}, {limited});
  const std::vector<double> low{-1}, high{0.7}, beyond{0.8};
  CHECK(says(sentence<std::invalid_argument>([&] { joint_motion(narrow, {1}, low, beyond); }), "outside its limits"));
  const joint_motion wide(narrow, {1}, low, high);
  for (const double t : {0.0, 0.1, 0.7, 1.0})
    CHECK(wide.at(t, std::vector<clearance::part_facts>(1)).poses.size() == 1);
}

}  // namespace joint_motion_test
