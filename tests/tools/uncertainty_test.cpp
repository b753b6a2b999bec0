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

TEST_CASE("A zone counts every point that may be in it, wherever points and links may be") {
  dice d(62);
  std::size_t moved = 0;
  for (int trial = 0; trial < 6; ++trial) {
    std::string text;
    std::vector<Eigen::Vector3d> points;
    for (int k = 0; k < 60; ++k) {
      const double z = d.uniform(0.9, 2), y = d.uniform(-1, 1), x = d.uniform(-1, 1);
      points.emplace_back(x, y, z);
      char line[128];
      std::snprintf(line, sizeof line, "%.9f %.9f %.9f\n", x, y, z);
      text += line;
    }
    const scratch_file urdf(".urdf", moving_boxes_text), cloud(".xyz", text);
    const std::string ask = "query --backend host --model triangles --robot " + urdf.path +
                            " --joint slide=0.1 --cloud " + cloud.path + " --zones 0.3,0.6";
    const std::string off = " --sensor lidar:0.01,0.01 --calibration 0.02,0 --joint-error 0.05,0";
    const auto bare = parsed(run_command(ask + " --json")), o = parsed(run_command(ask + off + " --json"));
    for (std::size_t part = 0; part < 2; ++part)
      for (std::size_t z = 0; z < 2; ++z) {
        const double within = z == 0 ? 0.3 : 0.6;
        std::size_t least = 0, most = 0;  // what rounding may leave open
        double nearest = 1e9;
        for (const Eigen::Vector3d& p : points) {
          const double away =
              to_box(p, part == 0 ? 0 : 0.6) - 3 * (0.01 + 0.01 * p.norm()) - 0.02 - (part == 0 ? 0 : 0.05);
          least += away < within - 1e-5, most += away < within + 1e-5;
          nearest = std::min(nearest, away + (part == 0 ? 0 : 0.05));
        }
        const auto& zone = o.at("parts").at(part).at("zones").at(z);
        CHECK(zone.at("points") >= least);
        CHECK(zone.at("points") <= most);
        if (least > 0) CHECK(zone.at("nearest").at("distance").get<double>() == Approx(nearest).margin(2e-5));
        moved += zone.at("points") != bare.at("parts").at(part).at("zones").at(z).at("points");
      }
    const outcome said = run_command(ask + off);
    CHECK(said.out.find(", wherever points and links may be\n") != said.out.npos);
    CHECK(said.code == (o.at("zones").at("innermost") == 0 ? 2 : 0));
  }
  CHECK(moved > 6);
}

TEST_CASE("clearance plan says of each row what query says is certain, until the plan ends") {
  const scratch_file urdf(".urdf", moving_boxes_text), rows(".csv", "slide,turn\n0,0\n0.3,1\n0.1,0\n"),
      cloud(".xyz", "0 0 1.1\n0.35 0 0\n5 5 5\n");
  const std::string how = " --backend host --robot " + urdf.path + " --cloud " + cloud.path +
                          " --sensor lidar:0.005,0.001 --calibration 0.002,0.001 --joint-error 0.01,0 --max-speed 0.5";
  for (const std::string model : {" --model triangles", " --model spheres --spheres 100"}) {
    const std::string ask = "plan --configurations " + rows.path + how + model + " --delay 0.02 --plan-time 0.08";
    const auto all = lines(run_command(ask));
    REQUIRE(all.size() == 4);
    double least = 1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      const char* const slides[] = {"0", "0.3", "0.1"};
      const auto alone =
          parsed(run_command("query --json --delay 0.1 --joint slide=" + std::string(slides[k]) + how + model))
              .at("certain");
      const auto& certain = all[k].at("certain");
      INFO(certain << '\n' << alone);
      CHECK(certain.at("lower").get<double>() == Approx(alone.at("lower").get<double>()).margin(1e-6));
      for (const char* key : {"state", "part"}) CHECK(certain.at(key) == alone.at(key));
      for (const char* key : {"cloud", "point"}) CHECK(certain.at(key) == alone.at("pair").at(key));
      least = std::min(least, certain.at("lower").get<double>());
    }
    CHECK(all[3].at("plan").at("certain") == nlohmann::json({{"least_lower", least}, {"at", 1}}));
    CHECK_FALSE(all[3].at("plan").contains("first_below"));
    const auto judged = [&](double margin) { return run_command(ask + " --check " + std::to_string(margin)); };
    CHECK(judged(least - 0.001).code == 0);
    CHECK(judged(least + 0.001).code == 2);  // as measured it is farther
    CHECK(lines(judged(least + 0.001)).back().at("plan").at("first_below") == 1);
    if (model == " --model triangles")
      CHECK(run_command(ask + " --csv --fields").out == run_command(ask + " --csv").out);
    std::istringstream table(run_command(ask + " --csv").out);
    std::string names, row;
    std::getline(table, names), std::getline(table, row);
    CHECK(names.ends_with(",nearest_z,certain_state,certain_lower,certain_part"));
    CHECK(row.ends_with(",free," + all[0].at("certain").at("lower").dump() + ',' +
                        all[0].at("certain").at("part").get<std::string>()));
  }
  const scratch_file blind(".xyz", "nan nan nan\n");
  const outcome dark = run_command("plan --backend host --model triangles --joint-error 0.1 --check 0.1 --robot " +
                                   urdf.path + " --configurations " + rows.path + " --cloud " + blind.path);
  CHECK(dark.code == 3);
  CHECK(lines(dark)[0].at("certain") ==
        nlohmann::json::parse(R"({"state": "no_data", "lower": null, "part": null, "cloud": null, "point": null})"));
  CHECK(lines(dark)[3].at("plan").at("certain") == nlohmann::json::parse(R"({"least_lower": null, "at": null})"));
  // Behind a camera, whose z is forward, its noise says nothing.
  const outcome behind = run_command("plan --backend host --model triangles --sensor kinect --robot " + urdf.path +
                                     " --configurations " + rows.path + " --cloud " + cloud.path);
  CHECK(behind.err.find("1 points may be anywhere, so nothing is free") != behind.err.npos);
  CHECK(lines(behind)[0].at("certain").at("lower") == 0);
  const auto fast =
      lines(run_command("plan --backend host --model triangles --max-speed 1e9 --delay 1 --plan-time 1 --robot " +
                        urdf.path + " --configurations " + rows.path + " --cloud " + cloud.path));
  CHECK(fast[0].at("certain") ==
        nlohmann::json::parse(R"({"state": "possible", "lower": 0.0, "part": null, "cloud": null, "point": null})"));
}

TEST_CASE("clearance run --plan says what plan says is certain, and each frame is about its own time") {
  const scratch_file urdf(".urdf", moving_boxes_text), still(".csv", "slide,turn\n0,0\n"),
      rows(".csv", "slide,turn\n0,0\n0.2,0\n"), first(".xyz", "0.7 0 0.5\n"), second(".xyz", "0.6 0 0.6\n0 0 2\n"),
      list(".txt", first.path + '\n' + second.path + '\n');
  const std::string how = " --backend host --model triangles --robot " + urdf.path +
                          " --sensor lidar:0.005,0.001 --max-speed 0.5 --delay 0.02 --joint-error 0.01,0";
  const std::string frames = "run --trajectory " + still.path + " --frames " + list.path + how;
  const std::string ask = frames + " --plan " + rows.path + " --plan-time 0.1";
  const auto all = lines(run_command(ask)), bare = lines(run_command(frames));
  REQUIRE(all.size() == 2);
  double least = 1e9;
  for (std::size_t k = 0; k < 2; ++k) {
    CHECK(all[k].at("certain") == bare[k].at("certain"));
    const auto alone = lines(run_command("plan --configurations " + rows.path + " --cloud " +
                                         (k == 0 ? first.path : second.path) + how + " --plan-time 0.1"));
    const auto& plan = all[k].at("plan");
    REQUIRE(plan.at("certain_lower").size() == 2);
    for (std::size_t row = 0; row < 2; ++row)
      CHECK(plan.at("certain_lower").at(row) == alone[row].at("certain").at("lower"));
    CHECK(plan.at("certain") == alone[2].at("plan").at("certain"));
    CHECK(plan.at("certain").at("least_lower") < all[k].at("certain").at("lower"));
    least = std::min(least, plan.at("certain").at("least_lower").get<double>());
  }
  CHECK(run_command(ask + " --check " + std::to_string(least - 0.001)).code == 0);
  const outcome fails = run_command(ask + " --csv --check " + std::to_string(least + 0.001));
  CHECK(fails.code == 2);
  std::istringstream table(fails.out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(names.ends_with(",plan_least,plan_at,plan_first_below,plan_certain_lower,plan_certain_at"));
  CHECK(row.ends_with(",," + all[0].at("plan").at("certain").at("least_lower").dump() + ",0"));
}

TEST_CASE("On the way between two rows joints err as they do where the arm is longest") {
  // Folded at both ends, up and down, and stretched between them; the shoulder turns it sideways to the point.
  const scratch_file urdf(".urdf", R"(<robot name="arm"><link name="base"/><link name="upper"/>
    <link name="hand"><collision><origin xyz="0.5 0 0"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
    </link>
    <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
    <joint name="elbow" type="continuous"><parent link="upper"/><child link="hand"/><origin xyz="0.5 0 0"/>
      <axis xyz="0 1 0"/></joint></robot>)");
  const scratch_file ends(".csv", "shoulder,elbow\n0,-2.8\n0,2.8\n"), cloud(".xyz", "1 0.5 0\n");
  std::string rows = "shoulder,elbow\n";
  for (int k = -140; k <= 140; ++k)
    for (const char* shoulder : {"-0.2", "0.2"}) rows += shoulder + (',' + std::to_string(0.02 * k)) + '\n';
  const scratch_file path(".csv", rows);
  const std::string how = " --backend host --model triangles --robot " + urdf.path + " --cloud " + cloud.path;
  const auto way = [&](const std::string& more) {
    return lines(run_command("plan --between --configurations " + ends.path + how + more))[0].at("way");
  };
  const double truly = lines(run_command("plan --configurations " + path.path + how)).back().at("plan").at("least"),
               exact = way("").at("lower"), certain = way(" --joint-error 0.2,0").at("lower");
  INFO(exact << ' ' << truly << ' ' << certain);
  CHECK(certain <= truly);
  CHECK(truly < exact - 0.17);    // more than the folded arm errs: its lever is below 0.25 m
  CHECK(certain > truly - 0.08);  // and not by much more than its lever, 1.1 m, says
  CHECK(way(" --joint-error 0.2,0").at("upper").get<double>() > way("").at("upper").get<double>());
  const auto vague = way(" --sensor lidar:0.01,0");
  CHECK(vague.at("upper").is_null());
  CHECK(vague.at("lower").get<double>() == Approx(exact - 0.03).margin(0.011));
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
  refuses(q.ask + " --sensor lidar:0.1,0 --shard", "--shard: cannot be mixed with --sensor");
  refuses(q.ask + " --calibration 0.1,0 --deadline 5", "--deadline: cannot be mixed with --calibration");
  refuses(m.ask + " --joint-error 1,2,3", "--joint-error: needs one number, or one for each of the robot's 2");
  refuses(m.ask + " --joint-error 1e300", "--joint-error: and --joint-speed move a link by more than 1e15 m");
  refuses(m.ask + " --joint-error -1", "--joint-error: needs 0 or more");
  refuses(m.ask + " --joint-speed 1", "--joint-speed: needs --delay");
  refuses(q.ask + " --max-speed 1 --delay 1 --plan-time 1", "--plan-time");
  const std::string plan = "plan --robot x --configurations y --cloud z", run = "run --robot x --frames y";
  for (const std::string& planned : {plan, run + " --plan z"}) {
    refuses(planned + " --max-speed 1 --delay 1", "--max-speed: needs --plan-time");
    refuses(planned + " --plan-time 1", "--plan-time: needs --max-speed");
    refuses(planned + " --max-speed 1 --delay 1 --plan-time -1", "--plan-time: must be from 0");
  }
  refuses(run + " --max-speed 1 --delay 1 --plan-time 1", "--plan-time: is for --plan");
  refuses(plan + " --sensor kinect --shard", "--shard: cannot be mixed with --sensor");
  const scratch_file rows(".csv", "slide,turn\n0,0\n0.2,0\n");
  const std::string far = "plan --backend host --model triangles --robot " + m.urdf.path + " --cloud " + m.cloud.path +
                          " --configurations " + rows.path + " --joint-error 0.1,0 --check 0.2 --d-max ";
  refuses(far + "0.25", "--d-max: must be above the margin of --check by more than 0.1 m");
  CHECK(run_command(far + "0.35").out.size() > 0);
  refuses(far + "1 --joint-speed 1,2,3 --delay 1", "--joint-speed: needs one number, or one for each of the robot's 2");
}

}  // namespace uncertainty_test
