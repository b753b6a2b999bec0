// SPDX-License-Identifier: BSD-3-Clause
// `run --stamps`: joints and frames have their own times. What is in between is interpolated, and what is beside is
// said, or widens what is certain.
#include "tools/two_boxes.hpp"

namespace stamps_test {

using namespace testing;

namespace {

/// The slide moves by 1 m/s, and samples are 0.1 s apart but for a gap from 0.2 to 0.6 s.
struct stamped_boxes {
  scratch_file urdf{".urdf", moving_boxes_text};
  scratch_file joints{".csv", "slide,time,turn\n0,100.0,3\n0.1,100.1,-3\n0.2,100.2,0\n0.6,100.6,0\n0.7,100.7,0\n"};
  scratch_file cloud{".xyz", "0 0 2\n0.5 0 0\n"};
  std::string robot = " --backend host --model triangles --robot " + urdf.path;

  std::string run(const std::string& stamps, const scratch_file& frames, const scratch_file& times) const {
    std::ofstream(times.path) << stamps;
    std::ofstream out(frames.path);
    for (const char c : stamps)
      if (c == '\n') out << cloud.path << '\n';
    out.close();
    return "run" + robot + " --frames " + frames.path + " --trajectory " + joints.path + " --stamps " + times.path;
  }
};

const char* const answered[] = {"state", "distance", "lower", "upper", "point", "part", "nearest_xyz", "points"};

}  // namespace

TEST_CASE("run --stamps asks about the joints at each frame's time") {
  const stamped_boxes b;
  const scratch_file frames(".txt"), times(".txt");
  const auto all = lines(run_command(b.run("100.05\n100.6\n100.675\n100.1\n", frames, times)));
  REQUIRE(all.size() == 4);
  const std::string slides[] = {"0.05", "0.6", "0.675", "0.1"};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto alone =
        parsed(run_command("query --json" + b.robot + " --joint slide=" + slides[k] + " --cloud " + b.cloud.path));
    CHECK(all[k].at("distance").get<double>() == Approx(alone.at("distance").get<double>()).margin(1e-6));
    CHECK(all[k].at("part") == alone.at("part"));
    CHECK(all[k].at("joints_off") == 0);
  }
  CHECK(all[2].at("stamp") == 100.675);
  // A sample at the very time is taken with its bits.
  const auto exact = parsed(run_command("query --json" + b.robot + " --joint slide=0.6 --cloud " + b.cloud.path));
  for (const char* key : answered) CHECK(all[1].at(key) == exact.at(key));
  const std::string table = run_command(b.run("100.05\n", frames, times) + " --csv").out;
  CHECK(table.find(",latency_us,stamp,joints_off\n") != table.npos);
  CHECK(table.ends_with(",100.05,0.0\n"));
}

TEST_CASE("Beside a single sample what is certain is wider by the joints' speeds, or the frame is refused") {
  const stamped_boxes b;
  const scratch_file frames(".txt"), times(".txt");
  const std::string ask = b.run("100.25\n100.05\n100.55\n", frames, times);
  refuses(ask, times.path + ":1: the joints' only sample near the stamp 100.25");
  refuses(ask, "--joint-speed says how far they move in it");
  const auto all = lines(run_command(ask + " --joint-speed 1,0"));
  REQUIRE(all.size() == 3);
  for (const std::size_t k : {0, 2}) {
    CHECK(all[k].at("joints_off").get<double>() == Approx(0.05).margin(1e-9));
    const auto& tool = all[k].at("parts").at(1);
    CHECK(tool.at("certain").at("shares").at("delay").get<double>() == Approx(0.05).margin(1e-6));
    // Where the slide really is, 1 m/s on from the sample, is within what is certain.
    const std::string truly = k == 0 ? "0.25" : "0.55";
    const auto there =
        parsed(run_command("query --json" + b.robot + " --joint slide=" + truly + " --cloud " + b.cloud.path));
    CHECK(tool.at("certain").at("lower") <= there.at("parts").at(1).at("distance"));
    CHECK(tool.at("certain").at("lower").get<double>() ==
          Approx(tool.at("distance").get<double>() - 0.05).margin(1e-5));
    CHECK(all[k].at("parts").at(0).at("certain").at("shares").at("delay") == 0);
  }
  CHECK(all[1].at("parts").at(1).at("certain").at("shares").at("delay") == 0);
  // A delay is on top.
  const auto late = lines(run_command(ask + " --joint-speed 1,0 --delay 0.1"));
  CHECK(late[0].at("parts").at(1).at("certain").at("shares").at("delay").get<double>() == Approx(0.15).margin(1e-6));
}

TEST_CASE("A time about which the samples say too little is refused, and so is what is no time") {
  const stamped_boxes b;
  const scratch_file frames(".txt"), times(".txt");
  const auto run = [&](const std::string& stamps) { return b.run(stamps, frames, times) + " --joint-speed 1"; };
  refuses(run("100.4\n"), times.path + ":1: the joints' sample that is nearest to the stamp 100.4");
  refuses(run("100.1\n99.8\n"), times.path + ":2: ");
  refuses(run("101\n"), "0.300000 s older (at most 0.1");
  CHECK(run_command(run("101\n") + " --max-age 0.5").code == 0);
  CHECK(lines(run_command(run("100.4\n") + " --max-age 0.21"))[0].at("joints_off") == 0);  // both are near enough
  refuses(run("100.1\nsoon\n"), times.path + ":2: ");
  refuses(run("100.1\nnan\n"), times.path + ":2");
  refuses(run("100.1\n\n100.2\n"), times.path + ":2");
  const std::string good = run("100.1\n100.2\n");
  std::ofstream(times.path) << "100.1\n";
  refuses(good, "--stamps: " + times.path + " has 1 lines, but there are 2 frames");
  std::ofstream(times.path) << "";
  refuses(good, times.path);

  const std::string one = b.run("100.1\n", frames, times);
  refuses(one + " --max-age -1", "--max-age: must be from 0");
  const auto with = [&](const std::string& rows) {
    std::ofstream(b.joints.path) << rows;
    return one;
  };
  refuses(with("slide,turn\n0,0\n"), b.joints.path + ":1: has no column named time");
  refuses(with("time,slide,time,turn\n"), "two columns named time");
  refuses(with("time,slide,turn\n1,0,0\n1,0,0\n"), b.joints.path + ":3: the stamp 1");
  refuses(with("time,slide,turn\n1,0,0\ninf,0,0\n"), b.joints.path + ":3");
  refuses(with("time,slide,turn\n"), "has no row");
  const std::string plain = "run" + b.robot + " --frames " + frames.path;
  refuses(plain + " --joint slide=0 --joint turn=0 --stamps " + times.path, "--stamps: needs --trajectory");
  with("time,slide,turn\n1,0,0\n");
  refuses(plain + " --trajectory " + b.joints.path, "the robot has no joint \"time\"");
  refuses(plain + " --joint slide=0 --joint turn=0 --max-age 1", "--max-age: is for --stamps");
}

}  // namespace stamps_test
