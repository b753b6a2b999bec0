// SPDX-License-Identifier: BSD-3-Clause
// How a distance changes with joints, compared with differences of distances that are asked anew at link_poses.
#include "io/random_tree.hpp"
#include "io/robot_folder.hpp"
#include "support/laws.hpp"
#include "support/scenes.hpp"

#include <clearance/io/jacobian.hpp>
#include <clearance/make_model.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/self_distance.hpp>
#include <clearance/volume/sphere.hpp>

namespace jacobian_test {

using namespace testing;
using namespace clearance::io;
using clearance::host, clearance::min_distance_per_part, clearance::part_witnesses;

namespace {

template <class P>
void against_differences() {
  verdict v;
  dice d(99);
  const double h = 1e-3;
  std::size_t compared = 0, moving = 0, followed = 0;
  for (int trial = 0; trial < 80; ++trial) {
    const auto [tree, q] = random_tree(d, 9, 0.3);
    std::vector<std::vector<P>> bodies;
    for (std::size_t k = 0; k < tree.links().size(); ++k) bodies.push_back(random_primitives<P>(d, 6, 0.1, 0.05));
    const auto model = clearance::make_model<clearance::sphere>(bodies);
    const auto points = d.points(40, 1.5);
    const Eigen::Isometry3d base = d.pose(1);
    const auto poses = [&](const std::vector<double>& at) {
      auto all = tree.link_poses(at);
      for (auto& pose : all) pose = base * pose;
      return all;
    };
    const auto here = poses(q);
    const auto minima = ask(host{}, model, here, points, min_distance_per_part{}).parts;
    const auto witnesses = ask(host{}, model, here, points, part_witnesses{minima});
    for (std::size_t i = 0; i < q.size(); ++i) {
      const auto ask = [&](double step) {
        auto there = q;
        there[i] += step;
        return clearance::ask(host{}, model, poses(there), points, min_distance_per_part{}).parts;
      };
      const auto before = ask(-h), after = ask(h);
      for (std::size_t k = 0; k < minima.size(); ++k) {
        const auto same = [&](const auto& m) {
          return m.point == minima[k].point && m.primitive == minima[k].primitive;
        };
        if (!same(before[k]) || !same(after[k]) || std::abs(minima[k].distance) < 0.05) continue;
        const auto g =
            joint_gradient(tree, here, k, clearance::gradient(witnesses[k], Eigen::Vector3d(here[k].translation())));
        const double rate = (double(after[k].distance) - double(before[k].distance)) / (2 * h);
        v.require(g && std::size_t(g->size()) == q.size(), "a gradient of part", k);
        if (!g) continue;
        // Mimic factors make a small step a larger one.
        v.require(std::abs((*g)[Eigen::Index(i)] - rate) < 5e-3 * (1 + std::abs(rate)), "part", k, ", value", i, ":",
                  (*g)[Eigen::Index(i)], " instead of", rate);
        ++compared, moving += std::abs(rate) > 0.05;
        for (std::size_t j = 0; j < tree.joints().size(); ++j)
          followed += tree.joints()[j].follows && tree.drive(j).value == i && std::abs(rate) > 0.05;
      }
    }
  }
  CHECK(compared > 1000);
  CHECK(moving > 300);
  CHECK(followed > 100);
}

}  // namespace

TEST_CASE("Gradients by joints of every kind, mimics among them, are those of differences: spheres") {
  against_differences<inner_sphere>();
}
TEST_CASE("Gradients by joints of every kind, mimics among them, are those of differences: triangles") {
  against_differences<triangle>();
}

TEST_CASE("A Jacobian is how a link's point moves") {
  verdict v;
  dice d(12);
  const double h = 1e-5;
  for (int trial = 0; trial < 30; ++trial) {
    const auto [tree, q] = random_tree(d, 10, 0.5);
    const auto poses = tree.link_poses(q);
    for (std::size_t link = 0; link < tree.links().size(); ++link) {
      const Eigen::Vector3d there(d.uniform(-1, 1), d.uniform(-1, 1), d.uniform(-1, 1));
      const auto all = jacobian(tree, poses, link, poses[link] * there);
      for (std::size_t i = 0; i < q.size(); ++i) {
        auto up = q, down = q;
        up[i] += h, down[i] -= h;
        const Eigen::Isometry3d a = tree.link_poses(up)[link], b = tree.link_poses(down)[link];
        const Eigen::Vector3d velocity = (a * there - b * there) / (2 * h);
        const Eigen::Matrix3d spin = (a.linear() - b.linear()) / (2 * h) * poses[link].linear().transpose();
        const Eigen::Vector3d turning(spin(2, 1), spin(0, 2), spin(1, 0));
        const auto column = all.col(Eigen::Index(i));
        v.require((column.head<3>() - velocity).norm() < 1e-6 && (column.tail<3>() - turning).norm() < 1e-6, "link",
                  link, ", value", i);
      }
    }
  }
}

TEST_CASE("What has no gradient has none by joints, and what is no link or part is refused") {
  dice d(5);
  const auto [tree, q] = random_tree(d, 4, 0.3);
  const auto poses = tree.link_poses(q);
  CHECK(!joint_gradient(tree, poses, 2, clearance::pose_gradient{}));
  CHECK(says(sentence<std::invalid_argument>([&] { jacobian(tree, poses, 9, {0, 0, 0}); }), "link number 9"));
  CHECK(says(sentence<std::invalid_argument>([&] { jacobian(tree, poses, poses.size(), {0, 0, 0}); }), "link number"));
  CHECK(says(sentence<std::invalid_argument>([&] { jacobian(tree, std::span(poses).first(2), 1, {0, 0, 0}); }),
             "2 poses"));

  struct small_part {
    std::size_t link;
  };
  struct {
    kinematic_tree tree;
    std::vector<small_part> list;
    const kinematic_tree& kinematics() const { return tree; }
    const std::vector<small_part>& parts() const { return list; }
  } robot{tree, {{3}, {1}}};
  clearance::part_witness w;
  w.part = 0, w.distance = 1, w.nearest = {0.3, 0.2, 0.1}, w.normal = {0, 0.6f, 0.8f};
  const auto g = clearance::gradient(w, clearance::position{1, 2, 3});
  REQUIRE(joint_gradient(robot, q, 0, g));
  CHECK((*joint_gradient(robot, q, 0, g) - *joint_gradient(tree, poses, 3, g)).norm() == 0);
  CHECK(says(sentence<std::invalid_argument>([&] { joint_gradient(robot, q, 2, g); }), "2 parts"));
  CHECK(!joint_gradient(robot, q, clearance::none, clearance::pose_gradient{}));
}

TEST_CASE("A row for each distance says what small steps say, of witnesses and of pairs") {
  dice d(21);
  verdict v;
  for (int round = 0; round < 20; ++round) {
    const auto [tree, q] = random_tree(d, 5, 0.3);
    struct part {
      std::size_t link;
    };
    struct {
      const kinematic_tree& tree;
      std::vector<part> list;
      const kinematic_tree& kinematics() const { return tree; }
      const std::vector<part>& parts() const { return list; }
    } robot{tree, {}};
    std::vector<std::vector<clearance::inner_sphere>> bodies;
    for (std::size_t k = 1; k < tree.links().size(); ++k) {
      robot.list.push_back({k});
      bodies.push_back({{{0.1f, 0.2f, -0.1f}, 0.05f}});
    }
    const auto model = clearance::make_model<clearance::sphere>(bodies);
    const Eigen::Isometry3d base = d.pose(0.5);
    const auto poses_at = [&](const std::vector<double>& at) {
      const auto links = tree.link_poses(at);
      std::vector<Eigen::Isometry3d> poses;
      for (const part& p : robot.list) poses.push_back(base * links[p.link]);
      return poses;
    };
    clearance::part_pairs pairs(robot.list.size());
    const std::vector<clearance::vec3> points{{2, 3, 1}};
    const auto seen = [&](const std::vector<double>& at) {
      return clearance::ask(clearance::host{}, model, poses_at(at), points, clearance::min_distances_per_part{});
    };
    const auto itself = [&](const std::vector<double>& at) {
      return clearance::self_distance(clearance::host{}, model, poses_at(at), pairs);
    };
    const auto parts = seen(q);
    const auto own = itself(q);
    const Eigen::MatrixXd of_parts = clearance::io::joint_gradients(robot, q, parts.of(0), {}, base);
    const Eigen::MatrixXd of_pairs = clearance::io::joint_gradients(robot, q, own.pairs, {}, base);
    v.require(std::size_t(of_parts.rows()) == robot.list.size() && std::size_t(of_pairs.rows()) == pairs.size() &&
                  std::size_t(of_parts.cols()) == tree.size(),
              "a row for each");
    const double h = 1e-3;
    for (std::size_t i = 0; i < q.size(); ++i) {
      auto up = q, down = q;
      up[i] += h, down[i] -= h;
      const auto a = seen(up), b = seen(down);
      for (std::size_t k = 0; k < robot.list.size(); ++k)
        v.require(std::abs(of_parts(Eigen::Index(k), Eigen::Index(i)) -
                           (double(a.all[k].distance) - double(b.all[k].distance)) / (2 * h)) < 2e-3,
                  "part", k, ", value", i);
      const auto c = itself(up), e = itself(down);
      for (std::size_t k = 0; k < own.pairs.size(); ++k)
        if (own.pairs[k].distance > -0.09f)  // their centres are apart
          v.require(std::abs(of_pairs(Eigen::Index(k), Eigen::Index(i)) -
                             (double(c.pairs[k].distance) - double(e.pairs[k].distance)) / (2 * h)) < 2e-2,
                    "pair", k, ", value", i);
    }
  }
}

TEST_CASE("A chain of mimics has the product of their factors, and none that is no number") {
  std::vector<joint> joints(3);
  for (int k = 0; k < 3; ++k) {
    joints[std::size_t(k)].name = "j" + std::to_string(k), joints[std::size_t(k)].kind = joint_kind::revolute;
    joints[std::size_t(k)].parent = "l" + std::to_string(k), joints[std::size_t(k)].child = "l" + std::to_string(k + 1);
  }
  joints[0].follows = mimic{"j2", -3, 0.5};
  joints[1].follows = mimic{"j0", 2, -1};
  const kinematic_tree tree({"l0", "l1", "l2", "l3"}, joints);
  CHECK((tree.drive(1).value == 0 && tree.drive(1).factor == -6 && tree.drive(1).offsets == 2));
  CHECK((tree.drive(2).value == 0 && tree.drive(2).factor == 1 && tree.drive(2).offsets == 0));
  CHECK((tree.joint_above(3) == 2 && tree.joint_above(0) == tree.none));
  joints[0].follows->multiplier = 1e200, joints[1].follows->multiplier = 1e200;
  CHECK(says(sentence<std::invalid_argument>([&] { kinematic_tree({"l0", "l1", "l2", "l3"}, joints); }), "not finite"));
}

}  // namespace jacobian_test
