// SPDX-License-Identifier: BSD-3-Clause
// Wherever joints are within their errors, a part's solid is within its radius; and samples hold where they are said
// to.
#include "io/random_tree.hpp"
#include "support/laws.hpp"

#include <clearance/io/part_radii.hpp>
#include <clearance/io/stamped_joints.hpp>

namespace part_radii_test {

using namespace testing;
using namespace clearance::io;
using Catch::Matchers::Contains;

namespace {

/// One joint about z, then an arm of 2 m along x with a joint that slides along it.
kinematic_tree arm() {
  joint turn{.name = "turn", .kind = joint_kind::continuous, .parent = "base", .child = "arm", .follows = {}};
  turn.axis = Eigen::Vector3d::UnitZ();
  joint slide{.name = "slide", .kind = joint_kind::prismatic, .parent = "arm", .child = "hand", .follows = {}};
  slide.origin.translation() << 2, 0, 0;
  slide.lower = -1, slide.upper = 1;
  return {{"base", "arm", "hand"}, {turn, slide}};
}

}  // namespace

TEST_CASE("A part's radius holds for every point of it, wherever the joints are within their errors") {
  verdict v;
  dice d(41);
  double tightest = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const auto [tree, q] = random_tree(d, 2 + d.below(9), trial % 3 == 0 ? 0.01 : 0.4);
    std::vector<std::size_t> links;
    std::vector<clearance::part_facts> facts;
    for (std::size_t k = 0; k < tree.links().size(); ++k) {
      links.push_back(k);
      facts.push_back({d.point(0.3), d.number(0, 0.2), d.number(0, 0.05), d.number(0, 0.05)});
    }
    std::vector<double> errors, speeds;
    const double size = std::pow(10, d.uniform(-4, 0)), delay = d.uniform(0, 0.5);
    for (std::size_t i = 0; i < q.size(); ++i) {
      errors.push_back(d.below(3) == 0 ? 0 : d.uniform(0, size));
      speeds.push_back(d.uniform(-size, size));
    }
    const auto radii = part_radii(tree, links, facts, q, {errors, speeds, delay}, {.ignore_limits = true});
    const auto still = part_radii(tree, links, facts, q, {errors}, {.ignore_limits = true});
    const auto poses = tree.link_poses(q, {.ignore_limits = true});
    for (int step = 0; step < 40; ++step) {
      std::vector<double> wrong = q, late = q;
      for (std::size_t i = 0; i < q.size(); ++i) {
        const double by = errors[i] * (step % 2 == 0 ? (d.below(2) == 0 ? 1 : -1) : d.uniform(-1, 1));
        wrong[i] += by, late[i] += by + delay * speeds[i];
      }
      const auto there = tree.link_poses(wrong, {.ignore_limits = true}),
                 then = tree.link_poses(late, {.ignore_limits = true});
      for (std::size_t k = 0; k < links.size(); ++k) {
        const vec3 n = d.direction();
        const Eigen::Vector3d p = clearance::center_of(facts[k]) +
                                  clearance::solid_radius(facts[k]) * Eigen::Vector3d(n.x, n.y, n.z).normalized();
        const double off = (poses[k] * p - there[k] * p).norm(), later = (poses[k] * p - then[k] * p).norm();
        v.require(off <= still[k].joints + 1e-12 && still[k].delay == 0 && still[k].joints == radii[k].joints, "link",
                  k, " is off by", off, " of at most", still[k].joints);
        v.require(later <= radii[k].sum() + 1e-12, "link", k, " is later off by", later, " of at most", radii[k].sum());
        if (radii[k].sum() > 1e-9) tightest = std::max(tightest, later / radii[k].sum());
      }
    }
  }
  CHECK((tightest > 0.7 && tightest <= 1));
}

TEST_CASE("Radii are levers times errors, and speeds times the delay") {
  const auto tree = arm();
  const std::vector<std::size_t> links{2};
  const std::vector<clearance::part_facts> facts{{{0.5f, 0, 0}, 0.25f}};
  const std::vector<double> q{0.3, 0.125}, errors{0.01, 0.002}, speeds{-1, 0.5};
  const auto r = part_radii(tree, links, facts, q, {errors, speeds, 0.1});
  CHECK(r[0].joints == Approx(0.002 + 0.01 * (2 + 0.125 + 0.5 + 0.25 + 0.002)));
  CHECK(r[0].sum() == Approx(0.052 + 0.11 * (2.875 + 0.052)));
  CHECK(part_radii(tree, links, facts, q, {})[0].sum() == 0);
}

TEST_CASE("Errors, speeds and delays that cannot be are refused") {
  const auto tree = arm();
  const std::vector<std::size_t> links{2}, nowhere{7};
  const std::vector<clearance::part_facts> facts{{{0, 0, 0}, 0.1f}};
  const std::vector<double> q{0, 0}, one{0.1}, negative{0.1, -0.1}, none{0.1, std::nan("")};
  const auto ask = [&](const joint_uncertainty& of) { return part_radii(tree, links, facts, q, of); };
  CHECK_THROWS_WITH(ask({.errors = one}), Contains("2 values, but there are 1 errors"));
  CHECK_THROWS_WITH(ask({.errors = negative}), Contains("the error of joint \"slide\""));
  CHECK_THROWS_WITH(ask({.errors = none}), Contains("the error of joint \"slide\""));
  CHECK_THROWS_WITH(ask({.speeds = none}), Contains("the speed of joint \"slide\""));
  CHECK_NOTHROW(ask({.speeds = negative}));
  CHECK_THROWS_WITH(ask({.delay = -1}), Contains("a delay is"));
  CHECK_THROWS_WITH(part_radii(tree, nowhere, facts, q, {}), Contains("none of number 7"));
  CHECK_THROWS_WITH(part_radii(tree, links, {}, q, {}), Contains("1 links of parts, but 0 facts"));
}

TEST_CASE("Between two samples joints are interpolated, beside one they may be off, and farther away it is said") {
  const auto tree = arm();
  stamped_joints all(tree, 0.5);
  CHECK_THROWS_WITH(all.at_stamp(1), Contains("no sample"));
  all.add(10, {3, 0}), all.add(10.4, {-3, 0.4}), all.add(20, {1, 1});
  const auto between = all.at_stamp(10.1);
  CHECK((between.values[0] == Approx(3 + 0.25 * (6.283185307179586 - 6)) && between.values[1] == Approx(0.1)));
  CHECK((between.off == 0 && all.at_stamp(10.4).values[1] == 0.4 && all.at_stamp(10.4).off == 0));
  CHECK((all.at_stamp(10.7).values[1] == 0.4 && all.at_stamp(10.7).off == Approx(0.3)));  // 20 is too far
  CHECK((all.at_stamp(9.75).values[0] == 3 && all.at_stamp(9.75).off == Approx(0.25)));
  CHECK_THROWS_WITH(all.at_stamp(15), Contains("4.600000 s older") && Contains("at most 0.5"));
  CHECK_THROWS_WITH(all.at_stamp(9), Contains("1.000000 s newer"));
  CHECK_THROWS_WITH(all.at_stamp(std::nan("")), Contains("nearest to the stamp"));
  CHECK_THROWS_WITH(all.add(20, {0, 0}), Contains("not after"));
  CHECK_THROWS_WITH(all.add(21, {0}), Contains("2 values, but there are 1"));
  CHECK_THROWS_WITH(all.add(21, {0, std::nan("")}), Contains("not finite"));
  CHECK_THROWS_WITH(stamped_joints(tree, -1), Contains("max_age"));
}

}  // namespace part_radii_test
