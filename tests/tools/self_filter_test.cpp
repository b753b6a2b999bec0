// SPDX-License-Identifier: BSD-3-Clause
// `--self-filter` hides the robot's own points.
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"
#include "tools/written_distances.hpp"

namespace self_filter_test {

using namespace testing;

TEST_CASE("--self-filter hides what is the robot's own from every question, and says how many points that are") {
  const two_boxes q;
  const scratch_file cloud(".xyz", "5 5 5\n0 0 0.605\n0 0 0.7\nnan 0 0\n0.3 0 0\n"),
      without(".xyz", "5 5 5\nnan 0 0\n0 0 0.7\nnan 0 0\n0.3 0 0\n");
  const scratch_file ply(".ply"), glb(".glb");
  const std::string ask = q.robot + " --json --self-filter 0.01 --check 0.05 --zones 0.02,0.15 --distances " +
                          ply.path + " --scene " + glb.path + " --cloud ";
  const outcome o = run_command(ask + cloud.path);
  CHECK(o.code == 0);
  const auto j = parsed(o), bare = parsed(run_command(q.robot + " --json --cloud " + without.path));
  CHECK(j.at("filter") ==
        nlohmann::json::parse(R"({"padding": 0.01, "own": 1, "uncertain": 0, "nearest_is": "rest"})"));
  for (const char* key :
       {"state", "distance", "lower", "upper", "point", "point_xyz", "part", "primitive", "nearest_xyz", "normal"})
    CHECK(j.at(key) == bare.at(key));
  CHECK(j.at("point") == 2);
  CHECK(j.at("points").at("seen") == 5);
  CHECK(j.at("points").at("valid") == 3);
  CHECK(j.at("points").at("dropped").at("masked") == 1);
  CHECK(j.at("points").at("dropped").at("not_finite") == 1);
  CHECK(j.at("parts").at(1).at("zones").at(0).at("points") == 0);
  CHECK(j.at("parts").at(1).at("zones").at(1).at("nearest").at("point") == 2);
  CHECK(j.at("distances").at("left_out") == 2);
  CHECK(records(ply.path).size() == 3);
  std::ifstream in(glb.path, std::ios::binary);
  CHECK(std::string(std::istreambuf_iterator<char>(in), {}).find("(the robot's own)") !=
        std::string::npos);  // hidden, and shown
  CHECK(run_command(q.robot + " --check 0.05 --cloud " + cloud.path).code == 2);
  CHECK(run_command(q.robot + " --self-filter 0.01 --cloud " + cloud.path)
            .out.find("1 points are the robot's own (within 0.01 m), and hidden; 0 may be") != std::string::npos);

  // What only may be its own stays.
  const auto edge = parsed(run_command(q.robot + " --json --self-filter 0.005 --cloud " + cloud.path));
  CHECK(edge.at("filter").at("own") == 0);
  CHECK(edge.at("filter").at("uncertain") == 1);
  CHECK(edge.at("filter").at("nearest_is") == "uncertain");
  CHECK(edge.at("point") == 1);
  CHECK_FALSE(parsed(run_command(q.ask)).contains("filter"));

  // A question about nothing but what is hidden is said to be one, and a state is that of the rest.
  const auto asked = [&](const std::string& more) {
    return run_command(q.robot + " --cloud " + cloud.path + " --self-filter " + more);
  };
  const outcome vain = asked("0.05 --check 0.05 --zones 0.03,0.1");
  CHECK(vain.code == 0);
  for (const std::string option : {"--check 0.05", "--zones 0.03"})
    CHECK(vain.err.find("note: " + option +
                        ": points that are certainly so near, an obstacle's too, are hidden by --self-filter 0.05") !=
          std::string::npos);
  CHECK(vain.out.starts_with("state     free, of the points that are not hidden\n"));
  CHECK(asked("0.01 --check 0.02 --zones 0.02").err.empty());
  CHECK(asked("0.001").out.starts_with("state     free\n"));

  // Where nothing is left, nothing is known; images keep their pixels' numbers.
  const scratch_file own(".xyz", "0 0 0.605\n"), depth(".png", png(0, 1000));
  for (const std::string& all : {own.path, depth.path + " --intrinsics 500,500,0,0 --camera-pose 0,0,-0.395,0,0,0,1"})
    for (const std::string check : {"", " --check 0"}) {
      const outcome blind = run_command(q.robot + " --json --self-filter 0.02" + check + " --cloud " + all);
      CHECK(blind.code == 3);
      CHECK(parsed(blind).at("state") == "no_data");
      CHECK(parsed(blind).at("filter").at("own") == 1);
      CHECK(parsed(blind).at("filter").at("nearest_is").is_null());
      CHECK(parsed(blind).at("points").at("dropped").at("masked") == 1);
      CHECK(parsed(blind).at("points").at("dropped").at("missing") == (all == own.path ? 0 : 1));
    }
  CHECK(run_command(q.robot + " --self-filter 0.02 --cloud " + own.path)
            .out.find("and hidden; no valid point is left\n") != std::string::npos);
}

TEST_CASE("run --self-filter says in every frame what query says, and --check is about the points that are left") {
  const scratch_file urdf(".urdf", moving_boxes_text), rows(".csv", "slide,turn\n0,0\n0.2,0\n0.2,0\n"),
      first(".xyz", "5 5 5\n0 0 0.605\n0 0 0.7\nnan 0 0\n"), second(".xyz", "0 0 0.805\n0 0 0.95\n"),
      own(".xyz", "0 0 0.805\n"), list(".txt", first.path + '\n' + second.path + '\n' + own.path + '\n'),
      two(".txt", first.path + '\n' + second.path + '\n'), few(".csv", "slide,turn\n0,0\n0.2,0\n");
  const std::string robot = " --backend host --model triangles --self-filter 0.01 --robot " + urdf.path;
  const outcome o = run_command("run --frames " + list.path + " --trajectory " + rows.path + robot);
  CHECK(o.code == 3);
  const auto all = lines(o);
  REQUIRE(all.size() == 3);
  const std::string frames[] = {"--joint slide=0 --cloud " + first.path, "--joint slide=0.2 --cloud " + second.path,
                                "--joint slide=0.2 --cloud " + own.path};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto alone = parsed(run_command("query --json " + frames[k] + robot));
    for (const char* key : {"filter", "state", "distance", "lower", "upper", "point", "part", "points"})
      CHECK(all[k].at(key) == alone.at(key));
  }
  CHECK(all[0].at("filter").at("own") == 1);
  CHECK(all[2].at("state") == "no_data");
  const std::string both = "run --frames " + two.path + " --trajectory " + few.path + robot;
  CHECK(run_command(both + " --check 0.05").code == 0);
  CHECK(run_command(both + " --check 0.12").code == 2);
  CHECK(run_command(both + " --check 0.01").err.find("note: --check 0.01: points that are certainly so near") !=
        std::string::npos);
  std::istringstream table(run_command(both + " --csv").out);
  std::string names, row;
  std::getline(table, names), std::getline(table, row);
  CHECK(names.ends_with(",latency_us,own,own_uncertain"));
  CHECK(row.ends_with(",1,0"));
  CHECK(lines(run_command(both + " --plan " + few.path))[0].at("plan").at("lower").at(0) ==
        lines(run_command(both))[0].at("lower"));
  refuses(both + " --merge", "--merge: cannot be mixed with --self-filter");
}

}  // namespace self_filter_test
