// SPDX-License-Identifier: BSD-3-Clause
#include "io/random_tree.hpp"
#include "io/robot_folder.hpp"
#include "support/laws.hpp"

#include <clearance/io/robot.hpp>

namespace freed_joints_test {

using namespace testing;
using namespace clearance::io;

namespace {

/// The values of all joints in a configuration, by the joints' names: those that follow others, too.
std::map<std::string, double> all_values(const kinematic_tree& tree, const std::vector<double>& q) {
  std::map<std::string, double> values;
  for (std::size_t j = 0; j < tree.joints().size(); ++j)
    if (tree.joints()[j].kind != joint_kind::fixed)
      values[tree.joints()[j].name] = tree.drive(j).factor * q[tree.drive(j).value] + tree.drive(j).offset;
  return values;
}

double apart(const std::vector<Eigen::Isometry3d>& a, const std::vector<Eigen::Isometry3d>& b) {
  double most = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    most = std::max(most, (a[k].matrix() - b[k].matrix()).cwiseAbs().maxCoeff());
  return most;
}

}  // namespace

TEST_CASE("A joint that is freed stands where its own value puts it, and what follows it goes on to follow") {
  verdict v;
  dice d(91);
  std::size_t freed_ones = 0, followed_on = 0;
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<joint> joints = random_tree(d, 12, 0.3).first.joints();
    for (std::size_t i = 1; i < joints.size(); ++i)  // chains of those that follow
      if (joints[i].movable() && joints[i - 1].follows && d.below(2) == 0)
        joints[i].follows = mimic{joints[i - 1].name, d.uniform(-2, 2), d.uniform(-0.3, 0.3)};
    const kinematic_tree tree({"l0", "l1", "l2", "l3", "l4", "l5", "l6", "l7", "l8", "l9", "l10", "l11"}, joints);
    std::vector<double> q(tree.size());
    for (double& value : q) value = d.uniform(-0.3, 0.3);
    std::vector<std::string> names;
    for (const joint& j : tree.joints())
      if (j.follows && d.below(2) == 0) names.push_back(j.name);
    v.require(followers_among(tree, names) == names, "those that follow others");
    const kinematic_tree free = freed(tree, names);
    v.require(free.size() == tree.size() + names.size(), "a value more for each");
    freed_ones += names.size();
    // With the values to which they would follow, nothing changes.
    const auto same = all_values(tree, q);
    std::vector<double> full;
    for (std::size_t i = 0; i < free.size(); ++i) full.push_back(same.at(free.movable(i).name));
    v.require(apart(free.link_poses(full, {true}), tree.link_poses(q, {true})) < 1e-12, "the same values");
    // With others, joints are where a tree without mimics has them.
    for (std::size_t i = 0; i < free.size(); ++i)
      if (std::ranges::count(names, free.movable(i).name)) full[i] += d.uniform(-0.5, 0.5);
    std::vector<joint> bare = tree.joints();
    for (joint& j : bare) j.follows.reset();
    const kinematic_tree all(tree.links(), bare);
    const auto values = all_values(free, full);
    std::vector<double> every;
    for (std::size_t i = 0; i < all.size(); ++i) every.push_back(values.at(all.movable(i).name));
    v.require(apart(free.link_poses(full, {true}), all.link_poses(every, {true})) < 1e-12, "other values");
    for (const joint& j : free.joints()) followed_on += j.follows && std::ranges::count(names, j.follows->joint);
  }
  CHECK(freed_ones > 100);
  CHECK(followed_on > 5);
}

TEST_CASE("Only joints that follow others can be freed, and a value is within the joint's own limits") {
  const auto moving = [](const std::string& name, const std::string& parent, const std::string& child) {
    joint j;
    j.name = name, j.kind = joint_kind::prismatic, j.parent = parent, j.child = child, j.lower = 0, j.upper = 1;
    return j;
  };
  std::vector<joint> joints{moving("grip", "hand", "left"), moving("grip2", "hand", "right")};
  joints[1].follows = mimic{"grip", 1, 0};
  const kinematic_tree tree({"hand", "left", "right"}, joints);
  CHECK(says(sentence<std::invalid_argument>([&] { freed(tree, {"grip"}); }), "no joint \"grip\" that follows"));
  CHECK(says(sentence<std::invalid_argument>([&] { freed(tree, {"none"}); }), "no joint \"none\" that follows"));
  CHECK(followers_among(tree, {"grip", "none", "grip2", "grip2"}) == std::vector<std::string>{"grip2"});
  CHECK(note_on_freed(tree, "grip2")
            .find("\"grip2\" has a value of its own here, which wins over what it would follow "
                  "\"grip\"") != std::string::npos);
  const kinematic_tree free = freed(tree, {"grip2"});
  CHECK(free.configuration({{"grip2", 0.5}}) == std::vector<double>{0, 0.5});
  CHECK(says(sentence<std::invalid_argument>([&] { free.configuration({{"grip2", 2}}); }), "\"grip2\" at 2.0"));
}

}  // namespace freed_joints_test
