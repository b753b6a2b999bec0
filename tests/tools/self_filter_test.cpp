// SPDX-License-Identifier: BSD-3-Clause
// `--self-filter` hides the robot's own points.
#include "io/robot_folder.hpp"
#include "support/random.hpp"
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

namespace {

/// A link like an hourglass, in OBJ, whose surface is not joined along one of its sides: left and right of the seam the
/// same curve has other corners. Its radius at z is 0.06 - 0.03 cos(10 pi z); z is -0.1 to 0.1.
std::string hourglass(dice& d) {
  const auto heights = [&](unsigned inner) {
    std::vector<double> z{-0.1, 0.1};
    while (inner-- > 0) z.push_back(d.uniform(-0.0999, 0.0999));
    std::sort(z.begin(), z.end());
    return z;
  };
  const std::vector<double> left = heights(60), right = heights(80);
  constexpr unsigned columns = 24;
  std::ostringstream text;
  text.precision(9);
  const auto column = [&](double angle, const std::vector<double>& z) {
    for (const double at : z) {
      const double r = 0.06 - 0.03 * std::cos(31.4159265 * at);
      text << "v " << r * std::cos(angle) << ' ' << r * std::sin(angle) << ' ' << at << '\n';
    }
  };
  for (unsigned k = 0; k < columns; ++k) column(6.283185307 * k / columns, left);
  column(6.283185307, right);  // the seam's other side
  text << "v 0 0 -0.1\nv 0 0 0.1\n";
  const std::size_t n = left.size(), ends = columns * n + right.size() + 1;
  for (unsigned k = 0; k < columns; ++k) {
    const std::size_t a = k * n + 1, b = (k + 1) * n + 1;
    const auto& beside = k + 1 < columns ? left : right;
    for (std::size_t i = 0, j = 0; i + 1 < n || j + 1 < beside.size();)
      if (j + 1 == beside.size() || (i + 1 < n && left[i + 1] < beside[j + 1]))
        text << "f " << a + i << ' ' << b + j << ' ' << a + i + 1 << '\n', ++i;
      else
        text << "f " << a + i << ' ' << b + j << ' ' << b + j + 1 << '\n', ++j;
    text << "f " << ends << ' ' << b << ' ' << a << "\nf " << ends + 1 << ' ' << a + n - 1 << ' '
         << b + beside.size() - 1 << '\n';
  }
  return text.str();
}

}  // namespace

TEST_CASE("A cap of a crack hides no obstacle: it hangs nowhere in front of the link") {
  dice d(5);
  const robot_folder folder;
  folder.put("link.urdf",
             "<robot name=\"r\"><link name=\"a\"><collision><geometry><mesh filename=\"link.obj\"/></geometry>"
             "</collision></link></robot>");
  for (int n = 0; n < 8; ++n) {
    folder.put("link.obj", hourglass(d));
    double truth = 1;
    const double away = 0.042, height = d.uniform(-0.01, 0.01);
    for (double z = -0.1; z < 0.1; z += 1e-5)
      truth = std::min(truth, std::hypot(away - (0.06 - 0.03 * std::cos(31.4159265 * z)), height - z));
    const auto cloud = folder.put("cloud.xyz", std::to_string(away) + " 0 " + std::to_string(height) + "\n");
    for (const std::string model : {"triangles", "spheres"}) {
      const outcome o =
          run_command("query --json --zones 0.005,0.02 --self-filter 0.005 --check 0.02 --model " + model +
                      " --robot " + (folder.path / "link.urdf").string() + " --cloud " + cloud.string());
      INFO(model << ", " << n << ": " << truth << '\n' << o.out << o.err);
      CHECK(o.code == 2);
      const auto j = parsed(o);
      CHECK(j.at("filter").at("own") == 0);
      CHECK(j.at("upper").get<double>() > truth - 0.0015);
      if (model == "spheres") continue;  // their gap is in the zones
      CHECK(j.at("parts").at(0).at("zones").at(0).at("points") == 0);
      CHECK(j.at("distance").get<double>() == Approx(truth).margin(0.0015));
    }
  }
}

}  // namespace self_filter_test
