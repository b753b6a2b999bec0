// SPDX-License-Identifier: BSD-3-Clause
// `--crop`, `--crop-out`, `--height` and `--plane` say where obstacles are; what is elsewhere is counted.
#include "tools/two_boxes.hpp"

#include <sstream>

namespace crop_test {

using namespace testing;
using Catch::Matchers::WithinAbs;

namespace {

/// The points are (5, 5, 5), (0, 0, 1), none and (0.3, 0, 0); the boxes are around (0, 0, 0) and (0, 0, 0.5).
void finds(const nlohmann::json& said, int point, double distance, int dropped) {
  CHECK(said.at("point") == point);
  CHECK_THAT(said.at("distance").get<double>(), WithinAbs(distance, 1e-6));
  const auto& points = said.at("points");
  CHECK((points.at("seen") == 4 && points.at("valid") == 3 - dropped && points.at("dropped").at("cropped") == dropped &&
         points.at("dropped").at("not_finite") == 1));
}

}  // namespace

TEST_CASE("Points that are no obstacles by their place are left out of every answer, and counted") {
  const two_boxes q;
  const auto ask = [&](const std::string& options) { return parsed(run_command(q.ask + options)); };
  finds(ask(""), 3, 0.2, 0);
  finds(ask(" --height 0.5,2"), 1, 0.4, 2);
  finds(ask(" --plane 0,0,2,0,0.05"), 1, 0.4, 1);
  finds(ask(" --crop -1,-1,-1,1,1,0.5"), 3, 0.2, 2);
  finds(ask(" --crop-out -1,-1,-inf,1,1,0.5"), 1, 0.4, 1);
  finds(ask(" --crop -inf,-inf,-inf,inf,inf,2 --plane 1,0,0,0.3,0.01"), 1, 0.4, 2);
  finds(ask(" --camera-pose 0,0,0.5,0,0,0,1 --height 0.5,2"), 3, 0.2, 1);  // in the world, not in the cloud's frame

  const auto nothing = run_command(q.ask + " --height 2,3");
  CHECK(nothing.code == 3);
  CHECK(parsed(nothing).at("points").at("dropped").at("cropped") == 3);

  const scratch_file ply(".ply");
  const auto zones = ask(" --height 0.5,2 --zones 0.25,0.5 --nearest 2 --self-filter 0.01 --distances " + ply.path);
  CHECK(zones.at("zones").at("innermost") == 1);
  CHECK((zones.at("distances").at("points") == 1 && zones.at("distances").at("left_out") == 3));
  CHECK(run_command(q.robot + " --cloud " + q.cloud.path + " --height 2,3").out.find("3 cropped") != std::string::npos);
}

TEST_CASE("A point that may be where obstacles are counts for what is certain") {
  const two_boxes q;
  const auto far = parsed(run_command(q.ask + " --height 0.5,2 --calibration 0.1,0")),
             near = parsed(run_command(q.ask + " --height 0.5,2 --calibration 0.51,0"));
  for (const auto& j : {far, near}) finds(j, 1, 0.4, 2);
  CHECK_THAT(far.at("certain").at("lower").get<double>(), WithinAbs(0.3, 1e-5));
  CHECK(near.at("certain").at("pair").at("point") == 3);
}

TEST_CASE("Recordings and plans are cropped, and so are merged frames") {
  const two_boxes q;
  const scratch_file frames(".txt", q.cloud.path + '\n'), rows(".csv", "\n\n");
  const std::string robot = " --backend host --model triangles --robot " + q.urdf.path;
  for (const std::string merge : {"", " --merge"}) {
    const auto o = run_command("run" + robot + " --frames " + frames.path + " --height 0.5,2" + merge);
    REQUIRE(o.code == 0);
    finds(nlohmann::json::parse(o.out), 1, 0.4, 2);
  }
}

TEST_CASE("What is no crop is refused in a sentence") {
  const two_boxes q;
  refuses(q.ask + " --crop 1,2", "--crop: needs 6 numbers, x0,y0,z0,x1,y1,z1; here are 2");
  refuses(q.ask + " --height 2,1", "--height: a crop's box has a lower end that is not below the upper one");
  refuses(q.ask + " --height nan,1", "--height: \"nan\" is not a finite number");
  refuses(q.ask + " --plane 0,0,0,1,1", "--plane: a crop's plane needs a normal that is not 0");
  refuses(q.ask + " --height 0,1 --height 0,1 --height 0,1 --crop 0,0,0,1,1,1 --crop-out 0,0,0,1,1,1",
          "--height: a crop has more than 4 boxes");
}

}  // namespace crop_test
