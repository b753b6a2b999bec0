// SPDX-License-Identifier: BSD-3-Clause
// `clearance self` says how far a robot is from itself: its bracket holds the distance of boxes whose places are known.
#include "tools/two_boxes.hpp"

#include <algorithm>
#include <cmath>

namespace self_test {

using namespace testing;
using nlohmann::json;

namespace {

/// Four boxes of 0.2 m: two on the base's slides, along x and z, and a finger that is fixed to the second.
const char* const slides = R"(<robot name="slides">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="left"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="finger"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="x" type="prismatic"><parent link="base"/><child link="left"/><axis xyz="1 0 0"/>
    <limit lower="-5" upper="5" effort="1" velocity="1"/></joint>
  <joint name="z" type="prismatic"><parent link="base"/><child link="right"/><axis xyz="0 0 1"/>
    <limit lower="-5" upper="5" effort="1" velocity="1"/></joint>
  <joint name="grip" type="fixed"><parent link="right"/><child link="finger"/><origin xyz="0 0 0.5"/></joint>
</robot>
)";

struct slides_robot {
  scratch_file urdf{".urdf", slides};
  std::string ask = "self --spheres 500 --robot " + urdf.path;
};

bool holds(const json& r, double distance) {
  return r.at("lower").get<double>() <= distance && distance <= r.at("upper").get<double>();
}

std::vector<std::string> pairs_of(const json& r) {
  std::vector<std::string> all;
  for (const json& pair : r.at("pairs"))
    all.push_back(pair.at("part_a").get<std::string>() + ' ' + pair.at("part_b").get<std::string>());
  std::ranges::sort(all);
  return all;
}

}  // namespace

TEST_CASE("clearance self brackets the distance of the two nearest links that can meet, and lists all pairs") {
  const slides_robot robot;
  const json r = parsed(run_command(robot.ask + " --joints 0.8,0.5 --json"));
  CHECK(r.at("state") == "free");
  CHECK(holds(r, std::hypot(0.6, 0.3)));  // left and right, by edges
  CHECK((r.at("part_a") == "left" && r.at("part_b") == "right"));
  CHECK(r.at("a_xyz").at(0) > 0.65);
  CHECK(r.at("b_xyz").at(0) < 0.15);
  CHECK(r.at("normal").at(0) > 0.8);  // from b to a
  const std::vector<std::string> can_meet{"base finger", "left finger", "left right"};
  CHECK(pairs_of(r) == can_meet);
  CHECK(r.at("pairs_that_can_meet") == 3);
  CHECK(r.at("srdf").is_null());
  const auto& pairs = r.at("pairs");
  for (std::size_t k = 1; k < pairs.size(); ++k) CHECK(pairs[k - 1].at("distance") <= pairs[k].at("distance"));
  CHECK(pairs[0].at("distance") == r.at("distance"));
  for (const json& pair : pairs) CHECK(pair.at("lower") <= pair.at("distance"));

  const std::string text = run_command(robot.ask + " --joints 0.8,0.5").out;
  CHECK(text.find("state     free\n") == 0);
  CHECK(text.find("part      left, sphere ") != text.npos);
  CHECK(text.find("pairs     3 can meet, all but neighbours\n") != text.npos);
}

TEST_CASE("clearance self fails --check by the lower end, and says what overlaps") {
  const slides_robot robot;
  CHECK(run_command(robot.ask + " --joints 0.8,0.5 --check 0.6").code == 0);
  CHECK(run_command(robot.ask + " --joints 0.8,0.5 --check 0.68").code == 2);
  const outcome o = run_command(robot.ask + " --joints 0,0.1 --json --check 0");
  CHECK(o.code == 2);
  CHECK(parsed(o).at("state") == "collision");
  CHECK(parsed(o).at("lower") == 0);
  CHECK(o.err.find("--srdf or --allow") != o.err.npos);
}

TEST_CASE("clearance self asks about the pairs that an SRDF file leaves, without those of --allow") {
  const slides_robot robot;
  const scratch_file srdf(".srdf", R"(<robot name="slides">
  <disable_collisions link1="left" link2="right" reason="Never"/>
  <disable_collisions link1="base" link2="left" reason="Adjacent"/>
</robot>)");
  const std::string ask = robot.ask + " --joints 0.8,0.5 --json --srdf " + srdf.path;
  const json r = parsed(run_command(ask));
  const std::vector<std::string> left{"base finger", "base right", "left finger", "right finger"};
  CHECK(pairs_of(r) == left);
  CHECK(r.at("srdf") == srdf.path);
  CHECK(holds(r, 0.3));  // base and right; right and finger, too
  const json fewer = parsed(run_command(ask + " --allow right=base --allow right=finger"));
  CHECK(pairs_of(fewer) == std::vector<std::string>{"base finger", "left finger"});
  CHECK(holds(fewer, 0.8));  // base and finger
  refuses(robot.ask + " --allow right=hand", "\"hand\" is no link with geometry");
  refuses(robot.ask + " --allow right=right", "with itself");
  refuses(robot.ask + " --allow right", "LINK=LINK");
  refuses(robot.ask + " --allow left=right --allow left=finger --allow base=finger", "no two of its links can meet");
  refuses(robot.ask + " --srdf " + robot.urdf.path + ".none", ".none");
  const scratch_file damaged(".srdf", "<robot name=\"slides\"><disable_collisions");
  refuses(robot.ask + " --srdf " + damaged.path, damaged.path);
}

TEST_CASE("What a link holds can meet all but what holds it, with an SRDF file, too") {
  const slides_robot robot;
  const scratch_file cube(".obj", cube_text), srdf(".srdf", R"(<robot name="slides"/>)");
  const std::string held = "right+" + std::filesystem::path(cube.path).filename().string(),
                    ask = robot.ask + " --joints 0.8,0.5 --json --attach right=" + cube.path;
  for (const std::string& more : {std::string(), " --srdf " + srdf.path}) {
    const auto pairs = pairs_of(parsed(run_command(ask + more)));
    const auto has = [&](const std::string& pair) { return std::ranges::count(pairs, pair) == 1; };
    INFO(more);
    CHECK(has("base " + held));
    CHECK(has("left " + held));
    CHECK_FALSE(has("right " + held));
    CHECK_FALSE(has("finger " + held));  // fixed joints hold all three together
    CHECK(has("right finger") == !more.empty());
  }
}

TEST_CASE("clearance self asks about every row of a path, as JSON and as CSV") {
  const slides_robot robot;
  const scratch_file rows(".csv", "z,x\n0.5,0.8\n0.5,0.6\n0,0\n");
  const std::string ask = robot.ask + " --configurations " + rows.path;
  const auto all = lines(run_command(ask + " --check 0.4"));
  REQUIRE(all.size() == 4);
  const double expected[] = {std::hypot(0.6, 0.3), std::hypot(0.4, 0.3), 0};
  for (std::size_t k = 0; k < 3; ++k) {
    CHECK(all[k].at("row") == k);
    CHECK(holds(all[k], expected[k]));
  }
  CHECK(all[2].at("state") == "collision");
  CHECK(all[3].at("self").at("rows") == 3);
  CHECK(all[3].at("self").at("at") == 2);
  CHECK(all[3].at("self").at("first_below") == 2);
  CHECK(all[3].at("check").at("passes") == false);
  CHECK(run_command(ask + " --check 0.4").code == 2);

  const json one = parsed(run_command(robot.ask + " --joints 0.8,0.5 --json"));
  CHECK(all[0].at("distance").get<double>() == Approx(one.at("distance").get<double>()).margin(1e-6));

  const outcome table = run_command(ask + " --csv --check 0.4");
  CHECK(table.code == 2);
  CHECK(table.err.find("row 2 is the first whose lower end is not above the margin") != table.err.npos);
  std::istringstream in(table.out);
  std::string head, line;
  std::getline(in, head);
  CHECK(head.starts_with("row,state,distance,lower,upper,part_a,part_b,"));
  for (std::size_t k = 0; std::getline(in, line); ++k) {
    CHECK(std::ranges::count(line, ',') == std::ranges::count(head, ','));
    CHECK(line.starts_with(std::to_string(k) + ',' + all[k].at("state").get<std::string>() + ','));
  }
  refuses(robot.ask + " --csv", "is for --configurations");
  refuses(ask + " --joints 0.8,0.5", "cannot be mixed with --configurations");
}

}  // namespace self_test
