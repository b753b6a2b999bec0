// SPDX-License-Identifier: BSD-3-Clause
// `--gradient` says how distances change.
#include "tools/two_boxes.hpp"

#include <array>

namespace gradient_test {

using namespace testing;

TEST_CASE("--gradient says how every part's distance changes with its pose and with the joints") {
  const moving_boxes m;
  const auto distances = [&](double slide) {
    const auto j = parsed(run_command(m.ask + " --gradient --joint slide=" + std::to_string(slide)));
    return std::array{j.at("parts").at(0).at("distance").get<double>(),
                      j.at("parts").at(1).at("distance").get<double>()};
  };
  const auto j = parsed(run_command(m.ask + " --gradient --base-pose 0,0,0.02,0,0,0,1"));
  const auto before = distances(0.01), after = distances(0.03);
  for (int k = 0; k < 2; ++k) {
    const auto g = j.at("parts").at(k).at("gradient");
    CHECK(g.at("state") == "known");
    CHECK(g.at("joints").at("slide").get<double>() == Approx((after[k] - before[k]) / 0.02).margin(1e-4));
    CHECK(g.at("joints").at("turn") == 0);
    CHECK(g.at("angular").size() == 3);
    CHECK(g.at("about").at(2).get<double>() == Approx(k == 0 ? 0.02 : 0.52));
  }
  CHECK(j.at("parts").at(0).at("gradient").at("linear").at(0).get<double>() == Approx(-1));
  CHECK(j.at("gradient").at("part") == j.at("part"));
  CHECK(j.at("gradient").at("joints") == j.at("parts").at(0).at("gradient").at("joints"));
  const std::string text = run_command("query --gradient --cloud " + m.cloud.path + m.robot).out;
  CHECK(text.find("slide -1.000000, turn +0.000000\n") != text.npos);

  const scratch_file inside(".xyz", "0 0 0\n"), blind(".xyz", "nan nan nan\n");
  const auto at_zero = parsed(run_command("query --json --gradient --cloud " + inside.path + m.robot)).at("gradient");
  CHECK(at_zero.at("state") == "at_zero");
  for (const char* key : {"linear", "angular", "joints"}) CHECK(at_zero.at(key).is_null());
  CHECK(run_command("query --gradient --cloud " + inside.path + m.robot).out.find("none: at_zero\n") !=
        std::string::npos);
  const outcome nothing = run_command("query --json --gradient --cloud " + blind.path + m.robot);
  CHECK(nothing.code == 3);
  CHECK(parsed(nothing).at("gradient").at("part").is_null());
  CHECK(parsed(nothing).at("parts").at(0).at("gradient").at("state") == "no_data");
  const two_boxes fixed;
  CHECK_FALSE(parsed(run_command(fixed.ask + " --gradient")).at("gradient").contains("joints"));
  CHECK_FALSE(parsed(run_command(fixed.ask)).contains("gradient"));
}

}  // namespace gradient_test
