// SPDX-License-Identifier: BSD-3-Clause
// Joint chains give the poses of link_poses for many configurations, and their errors name the culprit.
#include "io/random_tree.hpp"
#include "support/laws.hpp"

#include <clearance/io/joint_chain.hpp>

namespace joint_chain_test {

using namespace testing;
using namespace clearance::io;
using clearance::joint_chain, clearance::sine_cosine_of;

TEST_CASE("Sine and cosine are within a unit of rounding, of small and of large angles") {
  verdict v;
  dice d(5);
  for (const double top : {1e-9, 0.1, 0.8, 3.2, 100.0, 1e6, 1e9})
    for (int k = 0; k < 20000; ++k) {
      const double x = d.number(-top, top);
      const auto [s, c] = sine_cosine_of(x);
      const long double sine = std::sin((long double)x), cosine = std::cos((long double)x);
      v.require(std::abs(s - sine) <= 2.3e-16 * std::abs(sine) + 1e-18 &&
                    std::abs(c - cosine) <= 2.3e-16 * std::abs(cosine) + 1e-18,
                "at", x, ":", s, c);
    }
  const double quarter = std::acos(-1.0) / 2;
  for (int k = -9; k < 10; ++k)
    for (const double by : {-1e-12, 0.0, 1e-12}) {
      const double x = k * quarter + by;
      v.require(std::abs(sine_cosine_of(x).sine - std::sin((long double)x)) < 2e-16, "about", k, " quarter turns");
    }
  for (const double x : {-0x1p30, 0x1p30}) {  // the ends of its range belong to it
    v.require(std::abs(sine_cosine_of(x).sine - std::sin((long double)x)) < 3e-16, "at", x);
    v.require(std::isnan(sine_cosine_of(2 * x - x * (1 - 0x1p-52)).sine), "just beyond", x);
  }
  v.require(sine_cosine_of(0).sine == 0 && sine_cosine_of(0).cosine == 1, "at 0");
  for (const double none : {std::nan(""), 1e300, -1.1e9, double(clearance::infinity)})
    v.require(std::isnan(sine_cosine_of(none).sine), "of", none);
}

TEST_CASE("A joint chain puts parts where link_poses puts their links") {
  verdict v;
  dice d(77);
  std::size_t followed = 0, sliding = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto [tree, q] = random_tree(d, 9, 0.3);
    if (tree.size() == 0) continue;
    std::vector<std::size_t> links;
    for (std::size_t k = tree.links().size(); k-- > 0;) links.push_back(k);
    const Eigen::Isometry3d base = d.pose(2);
    const auto chain = joint_chain_of(tree, links, {}, base);
    std::vector<double> many = q, rest = tree.rest();
    many.insert(many.end(), rest.begin(), rest.end());
    const auto poses = chain.poses(many);
    v.require(poses.size() == 2 * links.size(), "how many poses:", poses.size());
    for (std::size_t c = 0; c < 2; ++c) {
      const auto expected = tree.link_poses(c == 0 ? q : rest);
      for (std::size_t k = 0; k < links.size(); ++k)
        v.require(
            ((base * expected[links[k]]).matrix() - poses[c * links.size() + k].matrix()).cwiseAbs().maxCoeff() < 1e-12,
            "configuration", c, ", part", k);
    }
    for (const auto& j : tree.joints()) followed += j.follows.has_value(), sliding += j.kind == joint_kind::prismatic;
  }
  CHECK((followed > 20 && sliding > 20));
}

TEST_CASE("A hundred thousand links may hang, and follow, one on another") {
  std::vector<std::string> links{"0"};
  std::vector<joint> joints;
  for (int k = 1; k <= 100'000; ++k) {
    joint j;
    j.name = "joint " + std::to_string(k), j.parent = links.back(), j.child = std::to_string(k),
    j.kind = joint_kind::prismatic;
    if (k > 1) j.follows = clearance::io::mimic{joints.back().name, k % 2 == 0 ? 1.0 : -1.0, 0.125};
    links.push_back(j.child), joints.push_back(std::move(j));
  }
  const clearance::io::kinematic_tree tree(links, joints);
  const double q[] = {0.5};
  const std::size_t last[] = {100'000};
  const auto poses = joint_chain_of(tree, last, {.ignore_limits = true}).poses(q);
  CHECK(poses[0].matrix() == tree.link_poses(q)[last[0]].matrix());
}

TEST_CASE("Ways that cancel are refused where double loses more of them than a bracket covers") {
  const auto chain = [](double there, double back) {
    clearance::chain_link first, second;
    first.origin.m[0][3] = there;
    second.origin.m[0][3] = back, second.origin.m[1][3] = 0.1, second.parent = 0, second.value = 0, second.factor = 1,
    second.slides = true;
    return joint_chain<>({first, second}, {1}, {{"slide", {}}});
  };
  const auto refused = [](const joint_chain<>& c, double q) {
    const double values[] = {q};
    CHECK(std::isnan(c.view().pose(values, 0).m[0][0]) == [&] {
      try {
        return c.poses(values).empty();
      } catch (const std::invalid_argument& e) {
        return std::string(e.what()).find("ways that cancel") != std::string::npos;
      }
    }());
    return std::isnan(c.view().pose(values, 0).m[0][0]);
  };
  CHECK(refused(chain(1e13, -1e13 + 0.3), 0));
  CHECK(refused(chain(1e13, 0), -1e13 + 0.3));
  CHECK(refused(chain(0.3, 1e12), -1e12));
  CHECK_FALSE(refused(chain(1e13, 0), 0.3));
  CHECK_FALSE(refused(chain(5e6, 0.1), 0.3));
  CHECK_FALSE(refused(chain(100.1, -100.3), 0.3));  // as a long gantry
  CHECK_FALSE(refused(chain(0.1, 0.2), 0.3));
}

TEST_CASE("Ways that vanish one by one are counted as lost, and what a bracket covers is not refused") {
  const clearance::position far{0x1p20, 0, 0}, little{0x1p-33, 0, 0};  // half a unit of rounding there
  clearance::chain_rounding r;
  constexpr int times = 10;
  for (int k = 0; k < times; ++k) {
    REQUIRE(far.x + little.x == far.x);
    r.step(far, little, far, little.x);
  }
  r.step(far, {-far.x, 0, 0}, {0, 0, 0}, far.x);
  const double lost = times * little.x;
  REQUIRE(lost > 1e-9);
  CHECK(r.lost >= lost);
  CHECK_FALSE(r.covered(0));
  CHECK(clearance::chain_rounding{.lost = 0x1p-45 * 1e6}.covered(1e6));
  CHECK_FALSE(clearance::chain_rounding{.lost = 0x1p-44 * 1e6}.covered(1e6));
}

TEST_CASE("Where a link is turned, exact ways lose more, and are refused if a bracket does not cover it") {
  const auto lost = [](bool turns) {
    clearance::chain_link first, second, third;
    first.value = 0, first.factor = 1;
    second.parent = 0, second.origin.m[0][3] = 3e6;
    if (turns)  // about the way, which stays as it is
      second.origin.m[1][1] = second.origin.m[2][2] = 0, second.origin.m[1][2] = -1, second.origin.m[2][1] = 1;
    third.parent = 1, third.origin.m[0][3] = -3e6;
    const joint_chain<> chain({first, second, third}, {2}, {{"turn", {}}});
    const double values[] = {0};
    return std::isnan(chain.view().pose(values, 0).m[0][0]);
  };
  CHECK(lost(true));
  CHECK_FALSE(lost(false));
}

TEST_CASE("A pose that is rigid but for its last digits becomes the nearest that is, and no other is taken") {
  verdict v;
  dice d(31);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Isometry3d pose = d.pose(2);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) pose(r, c) += d.uniform(-1, 1) * 1e-5;
    clearance::world_transform t(pose);
    v.require(make_rigid(t), "is not taken");
    const Eigen::Isometry3d made = to_isometry(t);
    const Eigen::Matrix3d rest = made.linear().transpose() * pose.linear();  // symmetric only of the nearest
    v.require((made.linear().transpose() * made.linear() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff() < 4e-15 &&
                  (rest - rest.transpose()).cwiseAbs().maxCoeff() < 4e-15 && made.translation() == pose.translation(),
              "is another pose");
  }
  const auto taken = [](int r, int c, double x) {
    clearance::world_transform t;
    t.m[r][c] = x;
    return make_rigid(t);
  };
  for (int r = 0; r < 3; ++r) {
    v.require(taken(r, 3, 1e18) && taken(r, 3, -1e18) && !taken(r, 3, 1.01e18) && !taken(r, 3, -1.01e18), "far ", r);
    v.require(!taken(r, r, -1) && !taken(r, r, 1.001) && taken(r, r, 1.00001), "scaled or mirrored ", r);
    v.require(!taken(r, (r + 1) % 3, 0.001) && !taken(r, (r + 2) % 3, -0.001), "sheared ", r);
    for (int c = 0; c < 4; ++c)
      for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
        v.require(!taken(r, c, x), "not finite ", r, " ", c);
        Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
        pose(r, c) = x;
        std::string why;
        try {
          clearance::rigid_transform_of(pose);
        } catch (const std::invalid_argument& e) {
          why = e.what();
        }
        v.require(why.find("not finite") != why.npos, why);
      }
  }
}

TEST_CASE("What is no joint vector is refused, by configuration and joint") {
  joint shoulder, elbow;
  shoulder.name = "shoulder", shoulder.parent = "base", shoulder.child = "upper", shoulder.lower = -1,
  shoulder.upper = 1;
  elbow.name = "elbow", elbow.parent = "upper", elbow.child = "fore";
  for (joint* j : {&shoulder, &elbow}) j->kind = joint_kind::revolute;
  const kinematic_tree tree({"base", "upper", "fore"}, {shoulder, elbow});
  const std::vector<std::size_t> links{1, 2};
  const auto chain = joint_chain_of(tree, links);
  const auto refusal = [](const auto& ask) -> std::string {
    try {
      ask();
    } catch (const std::invalid_argument& e) {
      return e.what();
    }
    return "nothing was refused";
  };
  const auto of = [&](std::vector<double> q) { return refusal([&] { chain.poses(q); }); };
  CHECK(of({0, 0, 2, 0}) ==
        "clearance: configuration 1: joint \"shoulder\" at 2.000000 is outside -1.000000 to 1.000000");
  CHECK(of({0, std::nan("")}).find("joint \"elbow\" at nan") != std::string::npos);
  CHECK(of({0, double(clearance::infinity)}).find("joint \"elbow\" at inf") != std::string::npos);
  CHECK(of({0, 0, 0}) == "clearance: 3 numbers are no whole joint vectors of 2");
  CHECK(chain.poses({}).empty());
  CHECK(joint_chain_of(tree, links, {.ignore_limits = true}).poses(std::vector<double>{2, 0}).size() == 2);
  CHECK(of({0, 2e9}) == "clearance: configuration 0: joint \"elbow\" turns a link by more than 2^30 rad");
  const double out[] = {2, 0};
  CHECK(std::isnan(chain.view().pose(out, 0).m[0][0]));  // where nobody can throw
  CHECK(refusal([&] { joint_chain_of(tree, std::vector<std::size_t>{3}); }) ==
        "the robot has 3 links, and none of number 3");
  clearance::chain_link ring;
  ring.parent = 0;
  CHECK(refusal([&] { joint_chain<>({ring}, {0}, {{"a", {}}}); }) ==
        "clearance: a joint chain has links that hang on no base");
  CHECK(refusal([&] { joint_chain<>({{}}, {1}, {{"a", {}}}); }) ==
        "clearance: a joint chain has a part that is link 1, which is none");
  CHECK(refusal([&] { joint_chain<>({{}}, {0}, {}); }) == "clearance: a joint chain has no joint that moves");
  clearance::chain_link thick;
  thick.value = 0, thick.axis = {2, 0, 0};
  CHECK(refusal([&] { joint_chain<>({thick}, {0}, {{"a", {}}}); }).find("axis of length 2") != std::string::npos);
  thick.axis = {1, 0, 0}, thick.value = 1;
  CHECK(refusal([&] { joint_chain<>({thick}, {0}, {{"a", {}}}); }).find("number 1, which is none") !=
        std::string::npos);
}

}  // namespace joint_chain_test
