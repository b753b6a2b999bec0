// SPDX-License-Identifier: BSD-3-Clause
// What a robot holds by `--attach`.
#include "tools/two_boxes.hpp"

#include <cmath>

namespace attach_test {

using namespace testing;

TEST_CASE("--attach puts a mesh or spheres on a link: one part more, in every command and for every question") {
  const moving_boxes m;
  const std::string holds = " --attach claw=" + m.cube.path + " --attach-pose 0,0,0.15,0,0,0,1",
                    name = "claw+" + m.file(m.cube);
  for (const std::string turn : {"0", "1.5707963267948966"}) {  // above the tool, or beside it
    const auto j = parsed(run_command(m.ask + holds + " --gradient --joint turn=" + turn));
    REQUIRE(j.at("parts").size() == 3);
    CHECK(j.at("parts").at(2).at("name") == name);
    CHECK(j.at("parts").at(2).at("attached") ==
          nlohmann::json({{"link", "claw"}, {"file", m.cube.path}, {"pose", {0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0}}}));
    CHECK_FALSE(j.at("parts").at(1).contains("attached"));
    CHECK(j.at("parts").at(2).at("distance").get<double>() == Approx(turn == "0" ? 0.3 : std::hypot(0.45, 0.1)));
    CHECK(j.at("parts").at(2).at("gradient").at("joints").at("slide").get<double>() ==
          Approx(turn == "0" ? -1 : -0.45 / std::hypot(0.45, 0.1)));
    if (turn != "0") CHECK(j.at("parts").at(2).at("gradient").at("joints").at("turn").get<double>() != 0);
  }
  const std::string text = run_command("query --cloud " + m.cloud.path + m.robot + holds).out;
  CHECK(text.find(name) != text.npos);
  CHECK(text.find(", held by link claw\n") != text.npos);
  const auto alone = parsed(run_command(m.ask)), held = parsed(run_command(m.ask + holds + " --exclude-link base"));
  CHECK(alone.at("part") == "base");
  CHECK(held.at("part") == name);

  // The robot's own points are also those of what it holds.
  const scratch_file touching(".xyz", "0 0 0.705\n0 0 1.0\n");
  const auto filtered =
      parsed(run_command("query --json --self-filter 0.01 --cloud " + touching.path + m.robot + holds));
  CHECK(filtered.at("filter").at("own") == 1);
  CHECK(filtered.at("distance").get<double>() == Approx(0.3));

  // Two of a kind, each with its pose, have names of their own; a link without geometry will do.
  const auto two = parsed(run_command(m.ask + holds + " --attach claw=" + m.cube.path));
  REQUIRE(two.at("parts").size() == 4);
  CHECK(two.at("parts").at(3).at("name") == name + " (2)");
  CHECK(two.at("parts").at(3).at("attached").at("pose").at(2) == 0);

  // Plans and recordings hold it as well.
  const scratch_file rows(".csv", "slide,turn\n0,0\n0.2,0\n"), list(".txt", m.cloud.path + '\n' + m.cloud.path + '\n');
  for (const std::string& line : {"plan --configurations " + rows.path + " --cloud " + m.cloud.path,
                                  "run --trajectory " + rows.path + " --frames " + list.path}) {
    const outcome o = run_command(line + m.robot + holds + " --exclude-link base");
    const auto first = nlohmann::json::parse(o.out.substr(0, o.out.find('\n')));
    CHECK(first.at("part") == name);
    CHECK(first.at("distance") == held.at("distance"));
  }
}

TEST_CASE("spheres that a link holds are what they are, or what their certificate says") {
  const moving_boxes m;
  const scratch_file csv(".csv", "x,y,z,r\n0,0,0,0.05\n"), ist(".ist"), glb(".glb");
  const std::string robot = "query --json --spheres 20 --no-cache --backend host --cloud " + m.cloud.path +
                            " --robot " + m.urdf.path + " --exclude-link base --scene " + glb.path,
                    at = " --attach-pose 0,0,0.15,0,0,0,1";
  const outcome o = run_command(robot + " --attach claw=" + csv.path + at);
  const auto j = parsed(o);
  CHECK(o.code == 0);
  CHECK(j.at("parts").at(1).at("gap") == 0);
  CHECK(j.at("parts").at(1).at("distance").get<double>() == Approx(0.3));
  CHECK(o.err.find("has no certificate, so its spheres themselves are taken for what link \"claw\" holds") !=
        std::string::npos);
  CHECK(run_command("pack " + m.cube.path + " --no-cache --spheres 20 --out " + ist.path).code == 0);
  const outcome proven = run_command(robot + " --attach claw=" + ist.path + at),
                packed = run_command(robot + " --attach claw=" + m.cube.path + at);
  CHECK(proven.err.find("certificate") == std::string::npos);
  for (const char* key : {"gap", "distance", "primitive"})
    CHECK(parsed(proven).at("parts").at(1).at(key) == parsed(packed).at("parts").at(1).at(key));
  CHECK(parsed(proven).at("lower") == parsed(packed).at("lower"));
}

}  // namespace attach_test
