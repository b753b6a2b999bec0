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
  const scratch_file svg(".svg");
  std::istringstream table(run_command(run + " --csv --svg " + svg.path).out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(
      names.ends_with(",latency_us,certain_state,certain_lower,certain_upper,base distance,base certain_lower,tool "
                      "distance,tool certain_lower"));
  CHECK(row.ends_with(',' + all[0].at("parts").at(1).at("distance").dump() + ',' +
                      all[0].at("parts").at(1).at("certain").at("lower").dump()));
  std::ifstream drawn(svg.path);
  const std::string picture(std::istreambuf_iterator<char>(drawn), {});
  CHECK(picture.find("id=\"certain-bracket\"") != picture.npos);
  CHECK(picture.find("grey: with what is uncertain") != picture.npos);
}

TEST_CASE("Joints that are wrong move the camera that a link carries, and so its points") {
  // The eye is 0.6 m above the base's middle, on the slide; a point 0.5 m before it is 0.4 m beside the base, say.
  const scratch_file slides(".urdf", boxes_with_eye_text), cloud(".xyz", "0.5 0 -0.6\n");
  const std::string seen = " --camera-link eye --cloud " + cloud.path;
  const std::string ask = "query --json --backend host --model triangles --robot " + slides.path + seen;
  const auto exact = parsed(run_command(ask + " --calibration 0,0"));
  const auto r = parsed(run_command(ask + " --joint-error 0.05,0"));
  CHECK(r.at("part") == "base");
  CHECK(r.at("certain").at("lower").get<double>() ==
        Approx(exact.at("certain").at("lower").get<double>() - 0.05).margin(1e-6));
  const auto& shares = r.at("parts").at(0).at("certain").at("shares");
  CHECK(shares.at("calibration").get<double>() == Approx(0.05).margin(1e-6));
  CHECK(shares.at("joints") == 0);
  CHECK(r.at("parts").at(1).at("certain").at("shares").at("joints").get<double>() == Approx(0.05).margin(1e-6));
  // With a delay the robot moves on, and what was seen stays.
  const auto late = parsed(run_command(ask + " --joint-speed 1,0 --delay 0.02"));
  CHECK(late.at("parts").at(0).at("certain").at("shares").at("calibration") == 0);
  CHECK(late.at("parts").at(1).at("certain").at("shares").at("delay").get<double>() == Approx(0.02).margin(1e-6));

  // A joint that turns the camera by 0.02 moves what is 2 m before it by the chord, and no more than it says.
  const scratch_file turns(".urdf", R"(<robot name="pan">
    <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link><link name="eye"/>
    <joint name="pan" type="continuous"><parent link="base"/><child link="eye"/><origin xyz="0.3 0 0"/>
      <axis xyz="0 0 1"/></joint></robot>)");
  const std::string pan = "query --json --backend host --model triangles --robot " + turns.path;
  const scratch_file far(".xyz", "0 2 0\n");
  const std::string there = " --camera-link eye --camera-pose 0.1,0,0,0,0,0,1 --cloud " + far.path;
  const auto wide = parsed(run_command(pan + there + " --joint-error 0.02"));
  for (const char* angle : {"0.02", "-0.02", "0.01"}) {
    const auto truly = parsed(run_command(pan + " --joint pan=" + angle + there));
    CHECK(wide.at("certain").at("lower") <= truly.at("distance"));
  }
  const auto& by_turn = wide.at("certain").at("pair").at("shares").at("calibration");
  CHECK(by_turn.get<double>() == Approx(0.02 * (0.1 + 2)).margin(1e-4));
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
