// SPDX-License-Identifier: BSD-3-Clause
// `--min-support` asks for a point that others confirm.
#include "tools/two_boxes.hpp"

namespace min_support_test {

using namespace testing;

TEST_CASE("--min-support tells the nearest point that others confirm, and what is nearer, but alone") {
  const two_boxes q;
  const scratch_file cloud(".xyz", "0 0 0.65\n0.3 0 0\n0.301 0 0\n0.302 0 0\n");
  const std::string ask = q.robot + " --json --cloud " + cloud.path;
  const outcome o = run_command(ask + " --min-support 3@0.01 --check 0.1");
  CHECK(o.code == 2);  // of all points: nothing is taken from it
  const auto j = parsed(o), s = j.at("support");
  CHECK(j.at("point") == 0);
  CHECK(s.at("state") == "free");
  CHECK(s.at("distance").get<double>() == Approx(0.2));
  CHECK(s.at("lower").get<double>() < s.at("distance").get<double>());
  CHECK(s.at("cloud") == cloud.path);
  CHECK(s.at("point") == 1);
  CHECK(s.at("part") == "base");
  CHECK(s.at("passes") == true);
  CHECK(s.at("complete") == true);
  CHECK(s.at("isolated") == 1);
  CHECK(s.at("nearest_isolated") ==
        nlohmann::json({{"distance", j.at("distance")}, {"cloud", cloud.path}, {"point", 0}, {"part", "tool"}}));
  CHECK(s.at("min_points") == 3);
  CHECK(s.at("radius") == 0.01);
  const std::string text = run_command(q.robot + " --min-support 3@0.01 --cloud " + cloud.path).out;
  CHECK(text.find("3 points within 0.01 m, point 1 and part base; 1 nearer points are alone, the first at 0.050000 m, "
                  "point 0 and part tool\n") != text.npos);

  const auto none = parsed(run_command(ask + " --min-support 3@0.0001 --check 0.01")).at("support");
  CHECK(none.at("state") == "possible");
  CHECK(none.at("passes") == false);
  for (const char* key : {"distance", "cloud", "point", "part", "primitive"}) CHECK(none.at(key).is_null());
  CHECK(none.at("lower") == 0);
  CHECK(none.at("isolated") == 4);
  CHECK(run_command(q.robot + " --min-support 3@0.0001 --cloud " + cloud.path)
            .out.find("no point has 3 points within 0.0001 m; 4 points are alone") != std::string::npos);
  CHECK(parsed(run_command(ask + " --min-support 2@0")).at("support").at("state") == "possible");
  const scratch_file blind(".xyz", "nan nan nan\n");
  const outcome nothing = run_command(q.robot + " --json --min-support 3@1 --check 0 --cloud " + blind.path);
  CHECK(nothing.code == 3);
  CHECK(parsed(nothing).at("support").at("state") == "no_data");
  CHECK(parsed(nothing).at("support").at("passes") == false);
  // What is hidden confirms nobody.
  const auto rest = parsed(run_command(ask + " --self-filter 0.2015 --min-support 2@0.01"));
  CHECK(rest.at("filter").at("own") == 3);
  CHECK(rest.at("support").at("isolated") == 1);
}

TEST_CASE("--min-support asks as many points as --support-limit says, and none where there are too few") {
  const two_boxes q;
  std::string dust;
  for (int k = 0; k < 20; ++k) dust += "0.3 0 " + std::to_string(0.001 * k * k) + "\n";
  const scratch_file cloud(".xyz", dust + "0.5 0 0\n0.5 0 0\n");
  const std::string ask = q.robot + " --json --cloud " + cloud.path + " --min-support ";
  const auto support = [&](const std::string& more) { return parsed(run_command(ask + more)).at("support"); };
  CHECK(support("2@0").at("point") == 20);
  CHECK(support("2@0 --support-limit 21").at("point") == 20);
  const auto few = support("2@0 --support-limit 20");
  CHECK(few.at("point").is_null());
  CHECK(few.at("complete") == false);
  CHECK(few.at("isolated") == 20);
  const auto none = support("23@10 --support-limit 5");
  CHECK(none.at("complete") == true);
  CHECK(none.at("isolated") == 22);
  CHECK(support("22@10 --support-limit 1").at("point") == 0);
  for (const std::string limit : {"0", "1048577", "-1", "x"})
    refuses(ask + "2@0 --support-limit " + limit,
            "--support-limit: \"" + limit + "\" is not a whole number from 1 to 1048576");
  refuses(q.ask + " --support-limit 5", "--support-limit: is for --min-support");
  CHECK(run_command("query --help").out.find("--support-limit") != std::string::npos);
}

TEST_CASE("a point that is certainly inside is a collision of --min-support, too") {
  const two_boxes q;
  const scratch_file inside(".xyz", "0 0 0.02\n0 0 0.021\n5 5 5\n");
  const auto j = parsed(run_command(q.robot + " --json --cloud " + inside.path + " --min-support 2@0.01"));
  CHECK(j.at("state") == "collision");
  CHECK(j.at("support").at("state") == "collision");
  CHECK(j.at("support").at("point") == j.at("point"));
}

}  // namespace min_support_test
