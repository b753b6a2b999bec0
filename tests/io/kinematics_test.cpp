// SPDX-License-Identifier: BSD-3-Clause
#include "io/robot_folder.hpp"
#include "support/catch.hpp"

#include <clearance/io/kinematics.hpp>

#include <array>
#include <numbers>
#include <random>

namespace kinematics_test {

using namespace clearance::io;

namespace {

using matrix = std::array<std::array<long double, 4>, 4>;

matrix product(const matrix& a, const matrix& b) {
  matrix c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j)
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

/// Rodrigues' formula, and a shift.
matrix turn(Eigen::Vector3d axis, long double angle, Eigen::Vector3d shift = Eigen::Vector3d::Zero()) {
  const long double n = std::sqrt((long double)axis.squaredNorm());
  const long double x = axis.x() / n, y = axis.y() / n, z = axis.z() / n, c = std::cos(angle), s = std::sin(angle),
                    v = 1 - c;
  return {{{c + x * x * v, x * y * v - z * s, x * z * v + y * s, shift.x()},
           {y * x * v + z * s, c + y * y * v, y * z * v - x * s, shift.y()},
           {z * x * v - y * s, z * y * v + x * s, c + z * z * v, shift.z()},
           {0, 0, 0, 1}}};
}

Eigen::Isometry3d to_eigen(const matrix& m) {
  Eigen::Isometry3d p;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) p.matrix()(i, j) = double(m[std::size_t(i)][std::size_t(j)]);
  return p;
}

joint moving(const std::string& name, const std::string& parent, const std::string& child,
             joint_kind kind = joint_kind::revolute) {
  joint j;
  j.name = name;
  j.kind = kind;
  j.parent = parent;
  j.child = child;
  j.axis = Eigen::Vector3d::UnitZ();
  j.lower = -1;
  j.upper = 2;
  return j;
}

std::string tree_refusal(std::vector<std::string> links, std::vector<joint> joints) {
  return sentence<std::invalid_argument>([&] { kinematic_tree(links, joints); });
}

}  // namespace

TEST_CASE("link poses are the product of all transforms above, by an independent formula") {
  std::mt19937 random(5);
  const auto any = [&](double low, double high) { return low + (high - low) * double(random()) / 4294967296.0; };
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<std::string> links{"l0"};
    std::vector<joint> joints;
    std::vector<matrix> expected{turn({1, 0, 0}, 0)};
    std::vector<double> q;
    for (std::size_t i = 1; i < 12; ++i) {
      const std::size_t parent = random() % i;
      links.push_back("l" + std::to_string(i));
      joint j = moving("j" + std::to_string(i), links[parent], links[i], joint_kind(random() % 4));
      j.lower = -7, j.upper = 7;
      j.axis = Eigen::Vector3d(any(-1, 1), any(-1, 1), any(-1, 1)) * 3;
      const Eigen::Vector3d shift(any(-1, 1), any(-1, 1), any(-1, 1)), about(any(-1, 1), any(-1, 1), any(-1, 1));
      const double angle = any(-3, 3), value = any(-6, 6);
      const matrix origin = turn(about, angle, shift);
      j.origin = to_eigen(origin);
      matrix motion = turn({1, 0, 0}, 0);
      if (j.kind == joint_kind::prismatic) motion = turn({1, 0, 0}, 0, value * j.axis.normalized());
      if (j.kind == joint_kind::revolute || j.kind == joint_kind::continuous) motion = turn(j.axis, value);
      if (j.kind != joint_kind::fixed) q.push_back(value);
      expected.push_back(product(product(expected[parent], origin), motion));
      joints.push_back(j);
    }
    const kinematic_tree tree(links, joints);
    REQUIRE(tree.size() == q.size());
    const auto poses = tree.link_poses(q);
    for (std::size_t i = 0; i < links.size(); ++i)
      CHECK((poses[i].matrix() - to_eigen(expected[i]).matrix()).cwiseAbs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("a configuration has the order of the joints given, and unset joints rest at 0 or the nearest limit") {
  std::vector<joint> joints{moving("z", "a", "b"), moving("y", "b", "c"), moving("x", "c", "d", joint_kind::continuous),
                            moving("f", "d", "e", joint_kind::fixed)};
  joints[0].lower = 0.5;
  joints[1].upper = -0.25;
  joints[2].lower = -joint{}.upper, joints[2].upper = joint{}.upper;
  const kinematic_tree tree({"a", "b", "c", "d", "e"}, joints);
  CHECK(tree.rest() == std::vector<double>{0.5, -0.25, 0});
  CHECK(tree.configuration({{"x", 100}, {"z", 2}}) == std::vector<double>{2, -0.25, 100});
  CHECK(tree.movable(0).name == "z");
  CHECK(tree.base() == 0);

  using error = std::invalid_argument;
  CHECK(says(sentence<error>([&] { tree.configuration({{"z", 0.4}}); }), "\"z\" at 0.4"));
  CHECK(tree.configuration({{"z", 0.4}}, {.ignore_limits = true})[0] == 0.4);
  CHECK(says(sentence<error>([&] { tree.link_poses(std::vector<double>{2.1, -0.25, 0}); }), "outside its limits"));
  CHECK(sentence<error>([&] { tree.link_poses(std::vector<double>{2.1, -0.25, 0}, {.ignore_limits = true}); }).empty());
  CHECK(sentence<error>([&] { tree.link_poses(std::vector<double>{2, -0.25, 0}); }).empty());
  CHECK(says(sentence<error>([&] { tree.link_poses(std::vector<double>{1, 0}); }), "3 movable joints, here are 2"));
  CHECK(says(sentence<error>([&] { tree.configuration({{"f", 0}}); }), "fixed"));
  CHECK(says(sentence<error>([&] { tree.configuration({{"none", 0}}); }), "no joint \"none\""));
  CHECK(
      says(sentence<error>([&] { tree.configuration({{"x", std::nan("")}}, {.ignore_limits = true}); }), "not finite"));
  CHECK(says(sentence<error>([&] { tree.link("none"); }), "no link \"none\""));
}

TEST_CASE("mimic joints follow, through chains, whatever the order they are given in") {
  std::vector<joint> joints{moving("third", "c", "d"), moving("second", "b", "c"), moving("first", "a", "b")};
  joints[0].follows = mimic{"second", 2, 0.1};
  joints[1].follows = mimic{"first", -3, 0.2};
  const kinematic_tree tree({"a", "b", "c", "d"}, joints);
  REQUIRE(tree.size() == 1);
  const double q = 0.3, second = -3 * q + 0.2, third = 2 * second + 0.1;
  const auto poses = tree.link_poses(std::vector<double>{q});
  const auto angle = [](const Eigen::Isometry3d& p) { return std::atan2(p.linear()(1, 0), p.linear()(0, 0)); };
  CHECK(angle(poses[1]) == Approx(q));
  CHECK(angle(poses[2]) == Approx(q + second));
  CHECK(angle(poses[3]) == Approx(q + second + third));
  CHECK(says(sentence<std::invalid_argument>([&] { tree.configuration({{"second", 0}}); }), "follows \"first\""));

  joints[2].follows = mimic{"third", 1, 0};
  CHECK(says(tree_refusal({"a", "b", "c", "d"}, joints), "follows itself"));
  joints[2].follows = mimic{"nobody", 1, 0};
  CHECK(says(tree_refusal({"a", "b", "c", "d"}, joints), "\"nobody\""));
  joints[2].follows.reset();
  joints[2].kind = joint_kind::fixed;
  CHECK(says(tree_refusal({"a", "b", "c", "d"}, joints), "fixed joint"));
}

TEST_CASE("what is not one tree of rigid joints is refused with the joint's name") {
  CHECK(says(tree_refusal({"a", "b"}, {}), "2 trees"));
  CHECK(says(tree_refusal({"a", "b"}, {moving("j", "a", "c")}), "no link \"c\""));
  CHECK(says(tree_refusal({"a", "b", "c"}, {moving("j", "b", "c"), moving("k", "c", "b")}), "ring"));
  CHECK(says(tree_refusal({"a"}, {moving("j", "a", "a")}), "0 trees"));
  CHECK(says(tree_refusal({"a", "b"}, {moving("j", "a", "b"), moving("k", "a", "b")}), "two joints above it"));
  CHECK(says(tree_refusal({"a", "b", "c"}, {moving("j", "a", "b"), moving("j", "a", "c")}), "two joints are named"));
  CHECK(says(tree_refusal({"a", "a"}, {}), "two links are named"));
  joint j = moving("j", "a", "b");
  j.origin.linear() *= 1.001;
  CHECK(says(tree_refusal({"a", "b"}, {j}), "\"j\" has an origin that is not a rigid"));
  j.origin.linear() = -Eigen::Matrix3d::Identity();
  CHECK(says(tree_refusal({"a", "b"}, {j}), "not a rigid"));
  j = moving("j", "a", "b");
  j.origin.translation().x() = std::nan("");
  CHECK(says(tree_refusal({"a", "b"}, {j}), "not a rigid"));
  j = moving("j", "a", "b");
  j.axis.setZero();
  CHECK(says(tree_refusal({"a", "b"}, {j}), "axis without direction"));
  j = moving("j", "a", "b");
  j.lower = 3;
  CHECK(says(tree_refusal({"a", "b"}, {j}), "lower limit above"));
}

}  // namespace kinematics_test
