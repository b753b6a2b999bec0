// SPDX-License-Identifier: BSD-3-Clause
// `--sensor`, `--calibration`, `--delay` and others: what is certain is what a plain loop over points and boxes says.
#include "support/random.hpp"
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

namespace uncertainty_test {

using namespace testing;

namespace {

/// The distance of a point from a box of 0.2 m whose middle is `up` above the origin.
double to_box(const Eigen::Vector3d& p, double up) {
  return (((p - Eigen::Vector3d(0, 0, up)).cwiseAbs().array() - 0.1).max(0)).matrix().norm();
}

}  // namespace

TEST_CASE("What is certain of a query is what all pairs say, share by share, and --check is about it") {
  dice d(61);
  std::size_t others = 0;
  for (int trial = 0; trial < 12; ++trial) {
    std::string text;
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 60; ++k) {
      const double z = d.uniform(0.9, 3), y = d.uniform(-2, 2), x = d.uniform(-2, 2);  // compilers order arguments
      points.emplace_back(x, y, z);
      char line[128];
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f\n", points.back().x(), points.back().y(), points.back().z());
      text += line;
    }
    const scratch_file urdf(".urdf", moving_boxes_text), cloud(".xyz", text);
    const double constant = 0.01, share = 0.05, shift = 0.02, turn = 0.03, speed = 0.5, delay = 0.1, error = 0.05,
                 joint_speed = 0.2, slide = 0.1;
    const auto o = parsed(run_command(
        "query --json --backend host --model triangles --robot " + urdf.path + " --joint slide=0.1 --cloud " +
        cloud.path +
        " --sensor lidar:0.01,0.05 --calibration 0.02,0.03 --max-speed 0.5 --delay 0.1 --joint-error 0.05,0 "
        "--joint-speed 0.2"));
    const auto& certain = o.at("certain");
    double lower = 1e9;
    std::size_t best = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double away = points[i].norm();
      const double radius = 3 * (constant + share * away) + shift + turn * away + speed * delay;
      const double base = to_box(points[i], 0) - radius,
                   tool = to_box(points[i], 0.5 + slide) - radius - error - delay * joint_speed;
      if (const double its = std::min(base, tool); its < lower) lower = its, best = i;
    }
    INFO(certain.dump());
    CHECK(certain.at("lower").get<double>() == Approx(std::max(lower, 0.0)).margin(2e-5));
    CHECK(certain.at("lower").get<double>() <= std::max(lower, 0.0));
    const auto& pair = certain.at("pair");
    const auto& shares = pair.at("shares");
    CHECK(pair.at("point") == best);
    CHECK(shares.at("noise").get<double>() == Approx(3 * (constant + share * points[best].norm())).epsilon(1e-4));
    CHECK(shares.at("calibration").get<double>() == Approx(shift + turn * points[best].norm()).epsilon(1e-4));
    CHECK(shares.at("time").get<double>() == Approx(speed * delay).epsilon(1e-4));
    CHECK(shares.at("joints").get<double>() == Approx(certain.at("part") == "tool" ? error : 0));
    CHECK(shares.at("delay").get<double>() == Approx(certain.at("part") == "tool" ? delay * joint_speed : 0));
    double sum = 0;
    for (const auto& one : shares) sum += one.get<double>();
    CHECK(pair.at("distance").get<double>() - sum == Approx(lower).margin(2e-5));
    others += pair.at("point") != o.at("point");
    for (const auto& part : o.at("parts")) CHECK(part.at("certain").at("lower") >= certain.at("lower"));
    if (lower < 0.01) continue;
    const std::string ask = "query --backend host --model triangles --robot " + urdf.path +
                            " --joint slide=0.1 --cloud " + cloud.path +
                            " --sensor lidar:0.01,0.05 --calibration 0.02,0.03 "
                            "--max-speed 0.5 --delay 0.1 --joint-error 0.05,0 --joint-speed 0.2 --check ";
    CHECK(run_command(ask + std::to_string(lower - 0.001)).code == 0);
    CHECK(run_command(ask + std::to_string(lower + 0.001)).code == 2);
  }
  CHECK(others > 0);
}

TEST_CASE("A sensor's options hold for clouds as --camera-pose does, and without them nothing about it is said") {
  const two_boxes q;
  CHECK_FALSE(parsed(run_command(q.ask)).contains("certain"));
  const auto lower = [&](const std::string& more) {
    return parsed(run_command(q.robot + " --json " + more)).at("certain").at("lower").get<double>();
  };
  const std::string cloud = " --cloud " + q.cloud.path;  // 0.2 m away is (0.3, 0, 0)
  CHECK(lower("--calibration 0.05,0" + cloud + cloud) == Approx(0.15).margin(1e-5));
  CHECK(lower(cloud + " --calibration 0.01,0" + cloud + " --calibration 0.15,0") == Approx(0.05).margin(1e-5));
  CHECK(lower(cloud + " --calibration 0,0.3") == Approx(0.1).margin(1e-5));
  const outcome o = run_command(q.robot + cloud + " --calibration 0.05,0");
  CHECK(o.out.find("certain   free: 0.1499") != std::string::npos);
  CHECK(o.out.find("less noise 0.000000, calibration 0.050000") != std::string::npos);
  const auto behind = parsed(run_command(q.ask + " --sensor kinect"));  // z is 0
  CHECK(behind.at("certain").at("lower") == 0);
  CHECK(behind.at("certain").at("anywhere") == 1);
  CHECK(behind.at("notes").dump().find("1 points may be anywhere") != std::string::npos);
}

TEST_CASE("clearance run says in every frame what query says is certain") {
  const scratch_file urdf(".urdf", moving_boxes_text), trajectory(".csv", "slide,turn\n0,0\n0.2,0\n"),
      first(".xyz", "0.7 0 0.5\n"), second(".xyz", "0.7 0 0.6\n0 0 2\n"),
      list(".txt", first.path + '\n' + second.path + '\n');
  const std::string off =
      " --sensor tof:0.01,0.001 --delay 0.2 --joint-speed 0.3,0 --backend host --model triangles --robot " + urdf.path;
  const std::string run = "run --frames " + list.path + " --trajectory " + trajectory.path + off;
  const auto all = lines(run_command(run));
  REQUIRE(all.size() == 2);
  const std::string frames[] = {"--joint slide=0 --cloud " + first.path, "--joint slide=0.2 --cloud " + second.path};
  for (std::size_t k = 0; k < 2; ++k)
    CHECK(all[k].at("certain") == parsed(run_command("query --json " + frames[k] + off)).at("certain"));
  const double lower =
      std::min(all[0].at("certain").at("lower").get<double>(), all[1].at("certain").at("lower").get<double>());
  CHECK(run_command(run + " --check " + std::to_string(lower - 0.001)).code == 0);
  CHECK(run_command(run + " --check " + std::to_string(lower + 0.001)).code == 2);
  CHECK(run_command(run + " --csv").out.find(",latency_us,certain_state,certain_lower,certain_upper\n") !=
        std::string::npos);
}

TEST_CASE("What is wrong about uncertainty is one sentence that names the option") {
  const two_boxes q;
  const moving_boxes m;
  refuses(q.ask + " --sensor lamp", "--sensor: \"lamp\" is none of kinect, stereo:F,B,S, tof:C,S and lidar:C,S");
  refuses(q.ask + " --sensor kinect:1", "--sensor: \"kinect:1\" is none of");
  refuses(q.ask + " --sensor stereo:1,2", "--sensor");
  refuses(q.ask + " --sensor stereo:0,0.05,0.1", "--sensor: a stereo camera's focal length and baseline");
  refuses(q.ask + " --sensor lidar:-1,0", "--sensor: a LiDAR's constant is -1");
  refuses(q.ask + " --sensor tof:0.1,nan", "--sensor");
  refuses(q.ask + " --calibration 0.1", "--calibration");
  refuses(q.ask + " --calibration 0.1,-0.1", "--calibration: needs 0 or more");
  refuses(q.ask + " --delay 0.1", "--delay: needs --max-speed or --joint-speed");
  refuses(q.ask + " --delay -1 --max-speed 1", "--delay: must be from 0");
  refuses(q.ask + " --max-speed 1", "--max-speed: needs --delay");
  refuses(q.ask + " --max-speed nan --delay 1", "--max-speed");
  refuses(q.ask + " --sensor lidar:0.1,0 --zones 0.1", "--sensor: cannot be mixed with --zones");
  refuses(q.ask + " --calibration 0.1,0 --deadline 5", "--deadline: is for the least distance alone");
  refuses(m.ask + " --joint-error 1,2,3", "--joint-error: needs one number, or one for each of the robot's 2");
  refuses(m.ask + " --joint-error -1", "--joint-error: needs 0 or more");
  refuses(m.ask + " --joint-speed 1", "--joint-speed: needs --delay");
  const scratch_file frames(".txt", ""), rows(".csv", "0\n");
  refuses("run --robot " + m.urdf.path + " --frames " + frames.path + " --plan " + rows.path + " --sensor kinect",
          "--sensor: cannot be mixed with --plan");
  refuses("plan --robot x --configurations y --cloud z --sensor kinect", "--sensor");
}

}  // namespace uncertainty_test
