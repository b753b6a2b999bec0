// SPDX-License-Identifier: BSD-3-Clause
// `--nearest` lists the nearest points of every part.
#include "tools/two_boxes.hpp"

namespace nearest_test {

using namespace testing;

TEST_CASE("--nearest lists the nearest points of every part, with what is certain") {
  const two_boxes q;
  const auto parts = parsed(run_command(q.ask + " --nearest 2")).at("parts");
  const auto base = parts.at(0).at("nearest"), tool = parts.at(1).at("nearest");
  REQUIRE((base.size() == 2 && tool.size() == 2));
  CHECK(base.at(0).at("point") == 3);
  CHECK(base.at(0).at("distance") == parts.at(0).at("distance"));
  CHECK(base.at(0).at("lower") <= base.at(0).at("distance"));
  CHECK(base.at(0).at("lower") > 0.1999);
  CHECK(base.at(0).at("pixel").is_null());
  CHECK(base.at(1).at("point") == 1);
  CHECK(tool.at(0).at("point") == 1);
  CHECK(tool.at(1).at("point") == 3);
  CHECK(tool.at(0).at("cloud") == q.cloud.path);
  const auto few = parsed(run_command(q.ask + " --nearest 9 --d-max 1")).at("parts");
  CHECK(few.at(0).at("nearest").size() == 2);  // the third is 8 m away, the fourth no point
  CHECK(parsed(run_command(q.ask + " --nearest 9")).at("parts").at(0).at("nearest").size() == 3);
  CHECK_FALSE(parsed(run_command(q.ask)).at("parts").at(0).contains("nearest"));
  const std::string text = run_command(q.robot + " --nearest 1 --d-max 0.3 --cloud " + q.cloud.path).out;
  CHECK(text.find("nearest points (of each link up to 1, within 0.3 m)\n  base") != text.npos);
  CHECK(text.find("point 3\n  tool                        none\n") != text.npos);
}

}  // namespace nearest_test
