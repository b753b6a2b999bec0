// SPDX-License-Identifier: BSD-3-Clause
// `--zones` counts the points around every part.
#include "tools/two_boxes.hpp"
#include "tools/written_distances.hpp"

#include <algorithm>

namespace zones_test {

using namespace testing;

TEST_CASE("--zones counts the points around every part, and names the nearest and the first") {
  const two_boxes q;
  const outcome o = run_command(q.ask + " --zones 0.1,0.5,1");
  CHECK(o.code == 0);
  const auto j = parsed(o);
  CHECK(j.at("zones") == nlohmann::json::parse(R"({"thresholds": [0.1, 0.5, 1.0], "min_points": 1, "innermost": 1})"));
  const auto base = j.at("parts").at(0).at("zones"), tool = j.at("parts").at(1).at("zones");
  REQUIRE(base.size() == 3);
  REQUIRE(tool.size() == 3);
  for (int z = 0; z < 3; ++z) CHECK(base.at(z).at("within") == j.at("zones").at("thresholds").at(z));
  CHECK(base.at(0).at("points") == 0);
  CHECK(base.at(0).at("nearest").is_null());
  CHECK(base.at(0).at("first").is_null());
  CHECK(base.at(1).at("points") == 1);
  CHECK(base.at(2).at("points") == 2);
  CHECK(base.at(2).at("nearest").at("distance").get<double>() == Approx(0.2));
  CHECK(base.at(2).at("nearest").at("cloud") == q.cloud.path);
  CHECK(base.at(2).at("nearest").at("point") == 3);
  CHECK(base.at(2).at("first") == nlohmann::json({{"cloud", q.cloud.path}, {"point", 1}}));
  CHECK(tool.at(0).at("points") == 0);
  CHECK(tool.at(1).at("points") == 2);
  CHECK(tool.at(2).at("nearest").at("point") == 1);

  // Each cloud keeps its name, and the answer is the same with the trees of any volume.
  const scratch_file other(".xyz", "0.25 0 0\n");
  for (const std::string volume : {"sphere", "aabb", "obb"}) {
    const auto two = parsed(run_command(q.ask + " --zones 0.3 --cloud " + other.path + " --volume " + volume))
                         .at("parts")
                         .at(0)
                         .at("zones")
                         .at(0);
    CHECK(two.at("points") == 2);
    CHECK(two.at("nearest").at("cloud") == other.path);
    CHECK(two.at("nearest").at("point") == 0);
    CHECK(two.at("first").at("cloud") == q.cloud.path);
  }
  const std::string text = run_command(q.robot + " --zones 0.1,0.5 --cloud " + q.cloud.path).out;
  CHECK(text.find("zones     the innermost is within 0.5 m\n") != text.npos);
  CHECK(text.find("0.5 m,        2 points, nearest 0.400000 m, point 1; first point 1\n") != text.npos);
  CHECK(text.find("0.1 m,        0 points\n") != text.npos);
  CHECK(run_command(q.robot + " --zones 0.1 --min-points 2 --cloud " + q.cloud.path).out.find("all are empty") !=
        text.npos);
  CHECK_FALSE(parsed(run_command(q.ask)).contains("zones"));
}

TEST_CASE("a point in the first zone is exit code 2, as a failed --check is, and no data is 3") {
  const two_boxes q;
  CHECK(run_command(q.ask + " --zones 0.15,0.5").code == 0);
  CHECK(run_command(q.ask + " --zones 0.25,0.5").code == 2);
  CHECK(run_command(q.ask + " --zones 0.2").code == 2);  // a point that may be within is within
  CHECK(run_command(q.ask + " --zones 0.15,0.5 --check 0.25").code == 2);
  CHECK(run_command(q.ask + " --zones 0.25 --check 0.1").code == 2);
  const outcome few = run_command(q.ask + " --zones 0.25,0.5 --min-points 2");
  CHECK(few.code == 0);
  CHECK(parsed(few).at("zones").at("innermost") == 1);
  CHECK(parsed(few).at("zones").at("min_points") == 2);
  CHECK(parsed(few).at("parts").at(0).at("zones").at(0).at("points") == 1);  // reported all the same
  CHECK(parsed(run_command(q.ask + " --zones 0.1 --min-points 3")).at("zones").at("innermost").is_null());
  CHECK(parsed(run_command(q.ask + " --zones 1e300")).at("parts").at(0).at("zones").at(0).at("points") == 3);

  const scratch_file blind(".xyz", "nan nan nan\n"), empty(".xyz", "# nothing\n");
  for (const auto* cloud : {&blind, &empty}) {
    const outcome o = run_command(q.robot + " --json --zones 0.1,0.5 --cloud " + cloud->path);
    CHECK(o.code == 3);
    CHECK(parsed(o).at("state") == "no_data");
    CHECK(parsed(o).at("zones").at("innermost") == 0);  // what is not known is not empty
    CHECK(run_command(q.robot + " --zones 0.1,0.5 --cloud " + cloud->path).out.find("nothing is known") !=
          std::string::npos);
  }
}

TEST_CASE("zones count what distances say, for a cloud of many points and both models") {
  scratch_file urdf{
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="0.2 0.3 0.4"/></geometry></collision></link>
      </robot>)"};
  std::string points;
  for (int i = 0; i < 500; ++i)
    points += std::to_string(0.01 * (i % 83)) + ' ' + std::to_string(-0.02 * (i % 29)) + ' ' +
              std::to_string(0.003 * (i % 101)) + '\n';
  const scratch_file cloud(".xyz", points), ply(".ply");
  for (const std::string model : {"triangles", "spheres --spheres 200 --no-cache"}) {
    const auto j =
        parsed(run_command("query --json --backend host --robot " + urdf.path + " --cloud " + cloud.path +
                           " --zones 0.0512345,0.212345,0.512345 --distances " + ply.path + " --model " + model));
    const auto all = records(ply.path);
    CHECK(all.size() == 500);
    const double gap = j.at("parts").at(0).value("gap", 0.0);
    for (const auto& zone : j.at("parts").at(0).at("zones")) {
      const double reach = zone.at("within").get<double>() + gap;
      const auto sure =
          std::ranges::count_if(all, [&](const distance_record& r) { return r.distance <= reach - 1e-5; });
      const auto perhaps =
          std::ranges::count_if(all, [&](const distance_record& r) { return r.distance <= reach + 1e-5; });
      INFO(model << " within " << reach);
      CHECK(sure > 0);
      CHECK(zone.at("points") >= sure);
      CHECK(zone.at("points") <= perhaps);
      CHECK(zone.at("nearest").at("distance") == j.at("distance"));
    }
  }
}

}  // namespace zones_test
