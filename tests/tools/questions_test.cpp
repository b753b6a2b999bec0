// SPDX-License-Identifier: BSD-3-Clause
// What `clearance query` answers besides the least distance, and what a robot holds by `--attach`.
#include "io/scratch_file.hpp"
#include "tools/run_command.hpp"
#include "tools/small_png.hpp"

#include <clearance/io/pcd.hpp>
#include <clearance/io/ply.hpp>

#include <cmath>
#include <cstring>

namespace questions_test {

namespace {

/// A box of 0.2 m at the origin, and a second one 0.5 m above it.
const char* const robot_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="mount" type="fixed"><parent link="base"/><child link="tool"/><origin xyz="0 0 0.5"/></joint>
</robot>
)";

struct question {
  scratch_file urdf{".urdf", robot_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n0.3 0 0\n"};  // 0.4 m above the tool, and 0.2 m beside the base
  std::string robot = "query --backend host --model triangles --robot " + urdf.path;
  std::string ask = robot + " --json --cloud " + cloud.path;
};

/// A second box of 0.2 m on a slide above the first, and a claw on it that turns and is no part.
const char* const moving_text = R"(<robot name="moving">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="claw"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="turn" type="continuous"><parent link="tool"/><child link="claw"/><axis xyz="1 0 0"/></joint>
</robot>
)";
/// A cube of 0.1 m.
const char* const cube_text =
    "v -.05 -.05 -.05\nv .05 -.05 -.05\nv .05 .05 -.05\nv -.05 .05 -.05\nv -.05 -.05 .05\nv .05 -.05 .05\nv .05 .05 "
    ".05\nv -.05 .05 .05\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

struct moving {
  scratch_file urdf{".urdf", moving_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n0.3 0 0\n"};
  scratch_file cube{".obj", cube_text};
  std::string robot = " --backend host --model triangles --robot " + urdf.path;
  std::string ask = "query --json --cloud " + cloud.path + robot;
  std::string file(const scratch_file& of) const { return std::filesystem::path(of.path).filename().string(); }
};

/// A record of the file that --distances writes.
struct record {
  double x, y, z;
  int red, green, blue;
  float distance;
  std::uint32_t cloud, point;
  std::int32_t part;
};

std::vector<record> records(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  std::string bytes(std::istreambuf_iterator<char>(in), {});
  const std::string end = "end_header\n";
  const std::size_t at = bytes.find(end);
  REQUIRE(at != bytes.npos);
  const std::string head = bytes.substr(0, at);
  CHECK(head.starts_with("ply\nformat binary_little_endian 1.0\n"));
  CHECK(head.find("property double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar "
                  "green\nproperty uchar blue\n"
                  "property float distance\nproperty uint cloud\nproperty uint point\nproperty int part\n") !=
        head.npos);
  std::vector<record> all;
  constexpr std::size_t size = 24 + 3 + 4 * 4;
  REQUIRE((bytes.size() - at - end.size()) % size == 0);
  for (const char* from = bytes.data() + at + end.size(); from < bytes.data() + bytes.size(); from += size) {
    record r{};
    std::memcpy(&r.x, from, 8), std::memcpy(&r.y, from + 8, 8), std::memcpy(&r.z, from + 16, 8);
    r.red = std::uint8_t(from[24]), r.green = std::uint8_t(from[25]), r.blue = std::uint8_t(from[26]);
    std::memcpy(&r.distance, from + 27, 4), std::memcpy(&r.cloud, from + 31, 4), std::memcpy(&r.point, from + 35, 4),
        std::memcpy(&r.part, from + 39, 4);
    all.push_back(r);
  }
  CHECK(clearance::io::load_ply(file).points.size() == all.size());
  return all;
}

}  // namespace

TEST_CASE("--zones counts the points around every part, and names the nearest and the first") {
  const question q;
  const outcome o = run_command(q.ask + " --zones 0.1,0.5,1");
  CHECK(o.code == 0);
  const auto j = parsed(o);
  CHECK(j.at("zones") == nlohmann::json::parse(R"({"thresholds": [0.1, 0.5, 1.0], "min_points": 1, "innermost": 1})"));
  const auto base = j.at("parts").at(0).at("zones"), tool = j.at("parts").at(1).at("zones");
  REQUIRE(base.size() == 3);
  REQUIRE(tool.size() == 3);
  for (int z = 0; z < 3; ++z) CHECK(base.at(z).at("within") == j.at("zones").at("thresholds").at(z));
  CHECK(base.at(0).at("points") == 0);
  CHECK(base.at(0).at("nearest").is_null());
  CHECK(base.at(0).at("first").is_null());
  CHECK(base.at(1).at("points") == 1);
  CHECK(base.at(2).at("points") == 2);
  CHECK(base.at(2).at("nearest").at("distance").get<double>() == Approx(0.2));
  CHECK(base.at(2).at("nearest").at("cloud") == q.cloud.path);
  CHECK(base.at(2).at("nearest").at("point") == 3);
  CHECK(base.at(2).at("first") == nlohmann::json({{"cloud", q.cloud.path}, {"point", 1}}));
  CHECK(tool.at(0).at("points") == 0);
  CHECK(tool.at(1).at("points") == 2);
  CHECK(tool.at(2).at("nearest").at("point") == 1);

  // Each cloud keeps its name, and the answer is the same with the trees of any volume.
  const scratch_file other(".xyz", "0.25 0 0\n");
  for (const std::string volume : {"sphere", "aabb", "obb"}) {
    const auto two = parsed(run_command(q.ask + " --zones 0.3 --cloud " + other.path + " --volume " + volume))
                         .at("parts")
                         .at(0)
                         .at("zones")
                         .at(0);
    CHECK(two.at("points") == 2);
    CHECK(two.at("nearest").at("cloud") == other.path);
    CHECK(two.at("nearest").at("point") == 0);
    CHECK(two.at("first").at("cloud") == q.cloud.path);
  }
  const std::string text = run_command(q.robot + " --zones 0.1,0.5 --cloud " + q.cloud.path).out;
  CHECK(text.find("zones     the innermost is within 0.5 m\n") != text.npos);
  CHECK(text.find("0.5 m,        2 points, nearest 0.400000 m, point 1; first point 1\n") != text.npos);
  CHECK(text.find("0.1 m,        0 points\n") != text.npos);
  CHECK(run_command(q.robot + " --zones 0.1 --min-points 2 --cloud " + q.cloud.path).out.find("all are empty") !=
        text.npos);
  CHECK_FALSE(parsed(run_command(q.ask)).contains("zones"));
}

TEST_CASE("a point in the first zone is exit code 2, as a failed --check is, and no data is 3") {
  const question q;
  CHECK(run_command(q.ask + " --zones 0.15,0.5").code == 0);
  CHECK(run_command(q.ask + " --zones 0.25,0.5").code == 2);
  CHECK(run_command(q.ask + " --zones 0.2").code == 2);  // a point that may be within is within
  CHECK(run_command(q.ask + " --zones 0.15,0.5 --check 0.25").code == 2);
  CHECK(run_command(q.ask + " --zones 0.25 --check 0.1").code == 2);
  const outcome few = run_command(q.ask + " --zones 0.25,0.5 --min-points 2");
  CHECK(few.code == 0);
  CHECK(parsed(few).at("zones").at("innermost") == 1);
  CHECK(parsed(few).at("zones").at("min_points") == 2);
  CHECK(parsed(few).at("parts").at(0).at("zones").at(0).at("points") == 1);  // reported all the same
  CHECK(parsed(run_command(q.ask + " --zones 0.1 --min-points 3")).at("zones").at("innermost").is_null());
  CHECK(parsed(run_command(q.ask + " --zones 1e300")).at("parts").at(0).at("zones").at(0).at("points") == 3);

  const scratch_file blind(".xyz", "nan nan nan\n"), empty(".xyz", "# nothing\n");
  for (const auto* cloud : {&blind, &empty}) {
    const outcome o = run_command(q.robot + " --json --zones 0.1,0.5 --cloud " + cloud->path);
    CHECK(o.code == 3);
    CHECK(parsed(o).at("state") == "no_data");
    CHECK(parsed(o).at("zones").at("innermost") == 0);  // what is not known is not empty
    CHECK(run_command(q.robot + " --zones 0.1,0.5 --cloud " + cloud->path).out.find("nothing is known") !=
          std::string::npos);
  }
}

TEST_CASE("--distances writes every valid point where it is in the world, with its distance, number, part and colour") {
  const question q;
  const scratch_file ply(".ply");
  const auto j = parsed(run_command(q.ask + " --distances " + ply.path));
  CHECK(j.at("distances") == nlohmann::json({{"file", ply.path},
                                             {"points", 3},
                                             {"left_out", 1},
                                             {"beyond", 0},
                                             {"signed", false},
                                             {"d_max", nullptr},
                                             {"blue_at", 1.0}}));
  auto all = records(ply.path);
  REQUIRE(all.size() == 3);
  CHECK(all[0].x == 5);
  CHECK(all[0].distance > 7);
  CHECK(std::array{all[0].red, all[0].green, all[0].blue} == std::array{0, 0, 255});
  CHECK(all[1].z == 1.0);
  CHECK(all[1].distance == Approx(0.4));
  CHECK(all[1].part == 1);
  CHECK(all[1].point == 1);
  CHECK(all[2].point == 3);  // 2 is none
  CHECK(all[2].part == 0);
  CHECK(all[2].distance == Approx(0.2));
  CHECK(all[2].red == 255);
  CHECK(all[2].green == 204);

  const scratch_file inside(".xyz", "0 0 0\n");
  const auto cut = parsed(run_command(q.ask + " --cloud " + inside.path + " --d-max 0.3 --distances " + ply.path));
  CHECK(cut.at("distances").at("beyond") == 2);
  CHECK(cut.at("distances").at("d_max").get<double>() == Approx(0.3));
  CHECK(cut.at("distance") == 0);
  all = records(ply.path);
  REQUIRE(all.size() == 4);
  for (const int k : {0, 1}) {
    CHECK(std::isinf(all[k].distance));
    CHECK(all[k].part == -1);
    CHECK(all[k].blue == 255);
  }
  CHECK(all[3].distance == 0);
  CHECK(all[3].cloud == 1);
  CHECK(all[3].point == 0);
  CHECK(std::array{all[3].red, all[3].green, all[3].blue} == std::array{255, 0, 0});

  // The nearest of all is what the query says.
  const auto alone = parsed(run_command(q.ask));
  records(ply.path);
  CHECK(alone.at("distance").get<float>() == all[2].distance);
  const std::string text =
      run_command(q.robot + " --cloud " + q.cloud.path + " --d-max 0.3 --distances " + ply.path).out;
  CHECK(text.find(ply.path + ": 3 points, 1 left out, 2 beyond 0.3 m; red at 0 m, blue at 0.3 m\n") != text.npos);
}

TEST_CASE("positions are those of the file, moved by poses in double, and images count their pixels") {
  const question q;
  const scratch_file ply(".ply"),
      far(".xyz", "447123.0625 5411987.125 251.0\n447123.0625 5411987.125 252.0009765625\n");
  run_command(q.robot + " --base-pose 447123.0625,5411987.125,250,0,0,0,1 --cloud " + far.path + " --distances " +
              ply.path);
  auto all = records(ply.path);
  REQUIRE(all.size() == 2);
  CHECK(all[0].x == 447123.0625);
  CHECK(all[0].y == 5411987.125);
  CHECK(all[1].z == 252.0009765625);
  CHECK(all[0].distance == Approx(0.4));
  const scratch_file depth(".png", png(0, 1000));
  run_command(q.robot + " --intrinsics 500,500,0,0 --camera-pose 0,0,1,0,0,0,1 --cloud " + depth.path +
              " --distances " + ply.path);
  all = records(ply.path);
  REQUIRE(all.size() == 1);
  CHECK(all[0].point == 1);
  CHECK(all[0].z == Approx(2));
  CHECK(all[0].x == Approx(0.002));
}

TEST_CASE("without a valid point the file of distances has none, and the exit code is 3") {
  const question q;
  const scratch_file ply(".ply"), blind(".xyz", "nan nan nan\n");
  CHECK(run_command(q.robot + " --cloud " + blind.path + " --distances " + ply.path).code == 3);
  CHECK(records(ply.path).empty());
}

TEST_CASE("zones count what distances say, for a cloud of many points and both models") {
  scratch_file urdf{
      ".urdf",
      R"(<robot name="r"><link name="a"><collision><geometry><box size="0.2 0.3 0.4"/></geometry></collision></link></robot>)"};
  std::string points;
  for (int i = 0; i < 500; ++i)
    points += std::to_string(0.01 * (i % 83)) + ' ' + std::to_string(-0.02 * (i % 29)) + ' ' +
              std::to_string(0.003 * (i % 101)) + '\n';
  const scratch_file cloud(".xyz", points), ply(".ply");
  for (const std::string model : {"triangles", "spheres --spheres 200 --no-cache"}) {
    const auto j =
        parsed(run_command("query --json --backend host --robot " + urdf.path + " --cloud " + cloud.path +
                           " --zones 0.0512345,0.212345,0.512345 --distances " + ply.path + " --model " + model));
    const auto all = records(ply.path);
    CHECK(all.size() == 500);
    const double gap = j.at("parts").at(0).value("gap", 0.0);
    for (const auto& zone : j.at("parts").at(0).at("zones")) {
      const double reach = zone.at("within").get<double>() + gap;
      const auto sure = std::ranges::count_if(all, [&](const record& r) { return r.distance <= reach - 1e-5; });
      const auto perhaps = std::ranges::count_if(all, [&](const record& r) { return r.distance <= reach + 1e-5; });
      INFO(model << " within " << reach);
      CHECK(sure > 0);
      CHECK(zone.at("points") >= sure);
      CHECK(zone.at("points") <= perhaps);
      CHECK(zone.at("nearest").at("distance") == j.at("distance"));
    }
  }
}

TEST_CASE("--scene shows the points in the colours of their distances") {
  const question q;
  const scratch_file ply(".ply"), plain(".glb"), coloured(".glb");
  CHECK(run_command(q.ask + " --scene " + plain.path).code == 0);
  CHECK(run_command(q.ask + " --scene " + coloured.path + " --distances " + ply.path).code == 0);
  const auto read = [](const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  CHECK(read(plain.path).size() == read(coloured.path).size());
  CHECK(read(plain.path) != read(coloured.path));
}

TEST_CASE("what is wrong with zones and distances is one sentence that names the option") {
  const question q;
  refuses(q.ask + " --zones 0.5,0.1", "--zones: needs thresholds in ascending order");
  refuses(q.ask + " --zones -0.1,0.1", "--zones: needs thresholds in ascending order, none below 0");
  refuses(q.ask + " --zones 0.1,,0.2", "--zones: \"\" is not a number");
  refuses(q.ask + " --zones 0.1,nan", "--zones: \"nan\" is not a finite number");
  refuses(q.ask + " --zones inf", "--zones: \"inf\" is not a finite number");
  refuses(q.ask + " --zones near", "--zones: \"near\" is not a number");
  refuses(q.ask + " --zones 0.1 --zones 0.2", "--zones");
  refuses(q.ask + " --zones 0.1 --min-points 0", "--min-points: \"0\" is not a whole number from 1");
  refuses(q.ask + " --zones 0.1 --min-points 1.5", "--min-points");
  refuses(q.ask + " --min-points 3", "--min-points: is for --zones");
  refuses(q.ask + " --d-max 3", "--d-max: is for --distances and --nearest");
  refuses(q.ask + " --signed", "--signed: is for --distances");
  refuses("query --robot " + q.urdf.path + " --cloud " + q.cloud.path + " --distances x.ply --signed",
          "--signed: is for --model triangles");
  refuses(q.ask + " --nearest 0", "--nearest: \"0\" is not a whole number from 1");
  refuses(q.ask + " --nearest 1048577", "--nearest: \"1048577\" is not a whole number from 1 to 1048576");
  refuses(q.ask + " --nearest 3 --deadline 5",
          "--deadline: is for the least distance alone, and cannot be mixed with --nearest");
  const scratch_file ply(".ply");
  for (const std::string value : {"0", "-1"})
    refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max: must be above 0");
  for (const std::string value : {"nan", "inf", "1,2", "x"})
    refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max");
  refuses(q.ask + " --distances out.xyz", "--distances: out.xyz: its name must end in .ply");
  refuses(q.ask + " --distances /nonexistent/folder/x.ply", "/nonexistent/folder/x.ply");
  refuses(q.ask + " --distances " + ply.path + " --scene " + ply.path, "--distances: is the same file as --scene");
  refuses(q.ask + " --distances " + ply.path + " --scene " + std::filesystem::path(ply.path).parent_path().string() +
              "/./" + std::filesystem::path(ply.path).filename().string(),
          "--distances: is the same file as --scene");
  const scratch_file input(".ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
                           "float z\nend_header\n3 0 0\n");
  refuses(q.robot + " --cloud " + input.path + " --distances " + input.path,
          input.path + ": is a file that this reads");
  refuses("run --robot x --frames y --zones 0.1", "--zones");
}

TEST_CASE("--self-filter hides what is the robot's own from every question, and says how many points that are") {
  const question q;
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

TEST_CASE("--min-support tells the nearest point that others confirm, and what is nearer, but alone") {
  const question q;
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

TEST_CASE("--gradient says how every part's distance changes with its pose and with the joints") {
  const moving m;
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
  const question fixed;
  CHECK_FALSE(parsed(run_command(fixed.ask + " --gradient")).at("gradient").contains("joints"));
  CHECK_FALSE(parsed(run_command(fixed.ask)).contains("gradient"));
}

TEST_CASE("--attach puts a mesh or spheres on a link: one part more, in every command and for every question") {
  const moving m;
  const std::string holds = " --attach claw=" + m.cube.path + " --attach-pose 0,0,0.15,0,0,0,1",
                    name = "claw+" + m.file(m.cube);
  for (const std::string turn : {"0", "1.5707963267948966"}) {  // above the tool, or beside it
    const auto j = parsed(run_command(m.ask + holds + " --gradient --joint turn=" + turn));
    REQUIRE(j.at("parts").size() == 3);
    CHECK(j.at("parts").at(2).at("name") == name);
    CHECK(j.at("parts").at(2).at("attached") ==
          nlohmann::json({{"link", "claw"}, {"file", m.cube.path}, {"pose", {0.0, 0.0, 0.15, 0.0, 0.0, 0.0, 1.0}}}));
    CHECK_FALSE(j.at("parts").at(1).contains("attached"));
    CHECK(j.at("parts").at(2).at("distance").get<double>() == Approx(turn == "0" ? 0.3 : std::hypot(0.45, 0.1)));
    CHECK(j.at("parts").at(2).at("gradient").at("joints").at("slide").get<double>() ==
          Approx(turn == "0" ? -1 : -0.45 / std::hypot(0.45, 0.1)));
    if (turn != "0") CHECK(j.at("parts").at(2).at("gradient").at("joints").at("turn").get<double>() != 0);
  }
  const std::string text = run_command("query --cloud " + m.cloud.path + m.robot + holds).out;
  CHECK(text.find(name) != text.npos);
  CHECK(text.find(", held by link claw\n") != text.npos);
  const auto alone = parsed(run_command(m.ask)), held = parsed(run_command(m.ask + holds + " --exclude-link base"));
  CHECK(alone.at("part") == "base");
  CHECK(held.at("part") == name);

  // The robot's own points are also those of what it holds.
  const scratch_file touching(".xyz", "0 0 0.705\n0 0 1.0\n");
  const auto filtered =
      parsed(run_command("query --json --self-filter 0.01 --cloud " + touching.path + m.robot + holds));
  CHECK(filtered.at("filter").at("own") == 1);
  CHECK(filtered.at("distance").get<double>() == Approx(0.3));

  // Two of a kind, each with its pose, have names of their own; a link without geometry will do.
  const auto two = parsed(run_command(m.ask + holds + " --attach claw=" + m.cube.path));
  REQUIRE(two.at("parts").size() == 4);
  CHECK(two.at("parts").at(3).at("name") == name + " (2)");
  CHECK(two.at("parts").at(3).at("attached").at("pose").at(2) == 0);

  // Plans and recordings hold it as well.
  const scratch_file rows(".csv", "slide,turn\n0,0\n0.2,0\n"), list(".txt", m.cloud.path + '\n' + m.cloud.path + '\n');
  for (const std::string& line : {"plan --configurations " + rows.path + " --cloud " + m.cloud.path,
                                  "run --trajectory " + rows.path + " --frames " + list.path}) {
    const outcome o = run_command(line + m.robot + holds + " --exclude-link base");
    const auto first = nlohmann::json::parse(o.out.substr(0, o.out.find('\n')));
    CHECK(first.at("part") == name);
    CHECK(first.at("distance") == held.at("distance"));
  }
}

TEST_CASE("spheres that a link holds are what they are, or what their certificate says") {
  const moving m;
  const scratch_file csv(".csv", "x,y,z,r\n0,0,0,0.05\n"), ist(".ist"), glb(".glb");
  const std::string robot = "query --json --spheres 20 --no-cache --backend host --cloud " + m.cloud.path +
                            " --robot " + m.urdf.path + " --exclude-link base --scene " + glb.path,
                    at = " --attach-pose 0,0,0.15,0,0,0,1";
  const outcome o = run_command(robot + " --attach claw=" + csv.path + at);
  const auto j = parsed(o);
  CHECK(o.code == 0);
  CHECK(j.at("parts").at(1).at("gap") == 0);
  CHECK(j.at("parts").at(1).at("distance").get<double>() == Approx(0.3));
  CHECK(o.err.find("has no certificate, so its spheres themselves are taken for what link \"claw\" holds") !=
        std::string::npos);
  CHECK(run_command("pack " + m.cube.path + " --no-cache --spheres 20 --out " + ist.path).code == 0);
  const outcome proven = run_command(robot + " --attach claw=" + ist.path + at),
                packed = run_command(robot + " --attach claw=" + m.cube.path + at);
  CHECK(proven.err.find("certificate") == std::string::npos);
  for (const char* key : {"gap", "distance", "primitive"})
    CHECK(parsed(proven).at("parts").at(1).at(key) == parsed(packed).at("parts").at(1).at(key));
  CHECK(parsed(proven).at("lower") == parsed(packed).at("lower"));
}

TEST_CASE("what is wrong with filter, support, gradient and what is held is one sentence that names the option") {
  const moving m;
  for (const std::string value : {"-0.01", "-1e-30", "1e16"})
    refuses(m.ask + " --self-filter " + value, "--self-filter: must be from 0 to 1e15");
  for (const std::string value : {"nan", "inf", "near", "0.1,0.2", "1e999"})
    refuses(m.ask + " --self-filter " + value, "--self-filter: ");
  refuses(m.ask + " --self-filter 0.1 --self-filter 0.1", "--self-filter");
  for (const std::string value : {"3", "3@", "@0.1", "@", "0@0.1", "-3@0.1", "2.5@0.1", "1@0.1", "3@-0.1", "3@nan",
                                  "3@inf", "3@1e16", "3@0.1@0.2", "99999999999@1"})
    refuses(m.ask + " --min-support " + value, "--min-support: ");
  refuses(m.ask + " --min-support 3@0.1 --min-support 3@0.1", "--min-support");

  const std::string cube = " --attach claw=" + m.cube.path, pose = " --attach-pose 0,0,0,0,0,0,1";
  for (const std::string& value : {std::string("claw"), std::string("="), std::string("claw="), "=" + m.cube.path})
    refuses(m.ask + " --attach " + value, "is not of the form LINK=FILE");
  refuses(m.ask + " --attach elbow=" + m.cube.path, "--attach: the robot has no link \"elbow\"");
  refuses(m.ask + " --attach claw=nowhere.stl", "nowhere.stl: there is no such file");
  refuses(m.ask + " --attach claw=" + m.cloud.path, m.cloud.path + ": ");
  refuses(m.ask + " --attach claw=/dev/zero", "/dev/zero: ");
  refuses(m.ask + pose + cube, "--attach-pose: is for the --attach before it, and there is none");
  refuses(m.ask + cube + pose + pose, "--attach-pose: is given twice for " + m.cube.path);
  for (const std::string value : {"0,0,0", "0,0,0,0,0,0,2", "nan,0,0,0,0,0,1", "1e19,0,0,0,0,0,1", "0,0,0,0,0,0"})
    refuses(m.ask + cube + " --attach-pose " + value, "--attach-pose: ");
  refuses(m.ask + cube + " --attach-pose 1e19,0,0,0,0,0,1", "--attach-pose: the pose of what is attached is not rigid");
  const scratch_file spheres(".csv", "0,0,0,0.05\n"), broken(".csv", "0,0,0,-1\n"),
      flat(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  refuses(m.ask + " --attach claw=" + spheres.path,
          "--attach: " + spheres.path + " holds spheres, which are for --model spheres");
  const std::string balls = "query --spheres 5 --no-cache --backend host --robot " + m.urdf.path + " --cloud " +
                            m.cloud.path + " --attach claw=";
  refuses(balls + "nowhere.csv", "nowhere.csv: there is no such file");
  refuses(balls + broken.path, broken.path + ":1: ");
  CHECK(run_command(balls + flat.path).err.find("encloses nothing") != std::string::npos);  // held all the same
  const scratch_file yaml(".yaml",
                          "collision_spheres:\n  a:\n    - {center: [0, 0, 0], radius: 0.1}\n  b:\n    - {center: [0, "
                          "0, 0], radius: 0.1}\n");
  refuses(balls + yaml.path, yaml.path + ": holds the spheres of 2 parts, and --attach takes those of one");
  for (const std::string more : {" --self-filter 0.1", " --min-support 3@0.1", " --gradient"}) {
    refuses("run --robot x --frames y" + more, more.substr(1, 10));
    refuses("plan --robot x --cloud y --configurations z" + more, more.substr(1, 10));
  }
  refuses(m.ask + " --svg x.svg", "--svg");
  const scratch_file input(
      ".ply",
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  refuses(m.ask + " --attach claw=" + input.path + " --distances " + input.path,
          input.path + ": is a file that this reads");
}

TEST_CASE("--deadline tells how many points are unseen, and what is certain all the same") {
  const question q;
  auto plain = parsed(run_command(q.ask + " --check 0.1")),
       all = parsed(run_command(q.ask + " --check 0.1 --deadline 1e9"));
  CHECK(all.at("deadline") == nlohmann::json({{"milliseconds", 1e9}, {"unseen", 0}, {"complete", true}}));
  for (auto& part : plain.at("parts"))
    for (const char* key : {"distance", "cloud", "point", "primitive"}) part.at(key) = nullptr;
  all.erase("deadline");
  for (auto* each : {&plain, &all}) each->erase("seconds");
  CHECK(all == plain);
  CHECK_FALSE(plain.contains("deadline"));
  CHECK(run_command(q.robot + " --deadline 1e9 --cloud " + q.cloud.path)
            .out.find("deadline  1e+09 ms: all points were looked at\n") != std::string::npos);

  for (const std::string never : {"0", "-0", "0.0"}) {
    const outcome o = run_command(q.ask + " --check 0 --deadline " + never);
    CHECK(o.code == 3);
    const auto none = parsed(o);
    CHECK(none.at("state") == "no_data");
    CHECK(none.at("check").at("passes") == false);
    CHECK(none.at("points").at("seen") == 0);
    CHECK(o.out.find("\"deadline\": {\n    \"milliseconds\": 0.0,\n    \"unseen\": 4,\n    \"complete\": false\n  }") !=
          std::string::npos);
    for (const char* key : {"distance", "lower", "upper", "point", "part"}) CHECK(none.at(key).is_null());
  }
  const outcome blind = run_command(q.robot + " --deadline 0 --cloud " + q.cloud.path);
  CHECK(blind.code == 3);
  CHECK(blind.out.find("state     no data: no valid point was seen in time, so nothing is known") == 0);
  CHECK(blind.out.find("deadline  0 ms: 4 of 4 points were not looked at, and may be anywhere\n") != std::string::npos);
}

TEST_CASE("a deadline between nothing and all is no free robot") {
  const question q;
  constexpr int count = 1'000'000;
  std::string bytes = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + std::to_string(count) +
                      "\nHEIGHT 1\nPOINTS " + std::to_string(count) + "\nDATA binary\n";
  for (int i = 0; i < count; ++i) {
    const float wall[] = {1.2f + 1e-6f * float(count - i), 0.001f * float(i % 1000) - 0.5f,
                          0.001f * float(i / 1000) - 0.5f},
                zero[3] = {};
    bytes.append(reinterpret_cast<const char*>(i % 7 == 0 ? zero : wall), sizeof wall);
  }
  const scratch_file cloud(".pcd", bytes);
  const std::string ask = q.robot + " --volume obb --range 0.9,3 --cloud " + cloud.path,
                    json = ask + " --json --check 0.1";
  const auto whole = parsed(run_command(json));
  CHECK(whole.at("state") == "free");
  bool cut = false;
  for (int turn = 0; turn < 30 && !cut; ++turn) {
    const outcome o = run_command(json + " --deadline 0.1");
    const auto some = parsed(o);
    const auto unseen = some.at("deadline").at("unseen").get<std::uint64_t>();
    CHECK(some.at("points").at("seen").get<std::uint64_t>() + unseen == count);
    CHECK(some.at("deadline").at("complete") == (unseen == 0));
    if (unseen == 0 || some.at("state") == "no_data") continue;
    cut = true;
    CHECK(some.at("state") == "possible");
    CHECK(o.code == 2);
    CHECK(some.at("check").at("passes") == false);
    CHECK(some.at("lower") == 0);
    CHECK(some.at("distance") >= whole.at("distance"));
    CHECK(some.at("upper") >= whole.at("upper"));
    CHECK_FALSE(some.at("part").is_null());
    CHECK(some.at("clouds").at(0).at("points") == count);
  }
  CHECK(cut);
  // Records that are (0,0,0) are counted as something that is left out, whichever of them were seen.
  for (const std::string by : {"0", "0.1", "1e9"}) {
    const auto counts = parsed(run_command(json + " --zero-is-missing --deadline " + by)).at("points");
    std::uint64_t sum = counts.at("valid");
    for (const auto& dropped : counts.at("dropped")) sum += dropped.get<std::uint64_t>();
    CHECK(sum == counts.at("seen"));
  }
}

TEST_CASE("what is wrong with a deadline or with ranks is one sentence that names the option") {
  const question q;
  for (const std::string value : {"-1", "-1e-300", "1e300", "1e10"})
    refuses(q.ask + " --deadline " + value, "--deadline: must be from 0 to 1e9 (milliseconds)");
  for (const std::string value : {"nan", "inf", "-inf", "soon", "1,2", "5ms", "1e999"})
    refuses(q.ask + " --deadline " + value, "--deadline: ");
  refuses(q.ask + " --deadline ''", "--deadline: has an empty value");
  refuses(q.ask + " --deadline 5 --deadline 5", "--deadline");
  refuses(q.ask + " --deadline 5 --volume aabb",
          "--volume: cannot be aabb with --deadline, which has obb for --model triangles");
  for (const std::string other :
       {"--zones 0.1", "--distances x.ply", "--self-filter 0.1", "--min-support 3@0.1", "--nearest 2", "--gradient"})
    refuses(q.ask + " --deadline 5 " + other, "--deadline: is for the least distance alone, and cannot be mixed with " +
                                                  other.substr(0, other.find(' ')));
  refuses("plan --robot x --cloud y --configurations z --deadline 5", "--deadline");
  for (const std::string option : {"--deadline 5", "--shard"})
    refuses("run --robot x --frames y " + option, option.substr(0, option.find(' ')));
  refuses(q.ask + " --shard --deadline 5", "--shard: cannot be mixed with --deadline");
  refuses(q.ask + " --shard --min-support 3@0.1", "--shard: cannot be mixed with --min-support");
  refuses(q.ask + " --shard --zones 0.1 --support-limit 5", "--support-limit: is for --min-support");
}

TEST_CASE("--shard without mpirun is one rank, or refused where there is no MPI") {
  const question q;
  const moving m;
  const scratch_file rows(".csv", "slide,turn\n0,0\n0.4,1\n1,2\n"), ply(".ply");
  const std::string plan = "plan --configurations " + rows.path + " --cloud " + m.cloud.path + m.robot;
  if (const outcome o = run_command(q.ask + " --shard"); o.code != 0) {
    for (const std::string& ask : {q.ask, plan})
      refuses(ask + " --shard", "--shard: this clearance was built without MPI");
    return;
  }
  const std::string moved = m.ask + " --joint slide=0.1 --joint turn=1";
  for (const std::string& ask : {
           q.ask,
           q.ask + " --zones 0.1,0.3,9 --min-points 2",
           q.ask + " --nearest 2 --d-max 1",
           q.ask + " --self-filter 0.21 --zones 0.1",
           moved + " --gradient",
           moved + " --attach claw=" + m.cube.path + " --self-filter 0.1 --nearest 9 --gradient",
           q.ask + " --distances " + ply.path + " --signed --d-max 3",
           plan,
           plan + " --d-max 0.25 --check 0.1",
           plan + " --between --check 0.1 --csv",
       }) {
    const auto without_times = [](std::string text) {
      const std::size_t begin = text.find("\"seconds\"");
      return begin == text.npos ? text : text.erase(begin, text.find('}', begin) - begin);
    };
    const outcome one = run_command(ask + " --shard"), plain = run_command(ask);
    INFO(ask);
    CHECK(one.code == plain.code);
    CHECK(one.err.find(plain.err) != std::string::npos);
    CHECK(!one.out.empty());
    CHECK(without_times(one.out) == without_times(plain.out));
  }
}

TEST_CASE("--nearest lists the nearest points of every part, with what is certain") {
  const question q;
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

TEST_CASE("--signed says how deep points are in a mesh") {
  const question q;
  const scratch_file cloud(".xyz", "0.02 0 0\n0.3 0 0\n0.05 0 0.5\n"), ply(".ply");
  const std::string ask = q.robot + " --json --cloud " + cloud.path + " --distances " + ply.path;
  const auto j = parsed(run_command(ask + " --signed"));
  CHECK(j.at("distances").at("signed") == true);
  const auto deep = records(ply.path);
  REQUIRE(deep.size() == 3);
  CHECK(std::abs(deep[0].distance + 0.08f) < 1e-6f);
  CHECK(std::abs(deep[1].distance - 0.2f) < 1e-6f);
  CHECK(std::abs(deep[2].distance + 0.05f) < 1e-6f);
  CHECK(deep[2].part == 1);
  CHECK(parsed(run_command(ask)).at("distances").at("signed") == false);
  CHECK(records(ply.path)[0].distance == 0);
}

TEST_CASE("a complete answer by a deadline has the lower end of the answer without one, where links have other gaps") {
  const question q;
  const scratch_file spheres(".csv", "0,0,0,0.05\n");
  const std::string ask = "query --backend host --no-cache --json --spheres 20 --robot " + q.urdf.path +
                          " --attach tool=" + spheres.path + " --cloud " + q.cloud.path;
  const auto plain = parsed(run_command(ask)), all = parsed(run_command(ask + " --deadline 1e9"));
  CHECK(all.at("deadline").at("complete") == true);
  for (const char* key : {"state", "distance", "lower", "upper", "point", "part"}) CHECK(all.at(key) == plain.at(key));
}

TEST_CASE("--min-support asks as many points as --support-limit says, and none where there are too few") {
  const question q;
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
  const question q;
  const scratch_file inside(".xyz", "0 0 0.02\n0 0 0.021\n5 5 5\n");
  const auto j = parsed(run_command(q.robot + " --json --cloud " + inside.path + " --min-support 2@0.01"));
  CHECK(j.at("state") == "collision");
  CHECK(j.at("support").at("state") == "collision");
  CHECK(j.at("support").at("point") == j.at("point"));
}

TEST_CASE(
    "what a small file would become is counted with all that is asked, and refused with the limit and the option that "
    "raises it") {
  const question q;
  const std::uint32_t points = 1'000'000;  // that are all 0, three bytes each
  const std::string zeros(3 * std::size_t(points), '\0');
  std::string data(zeros.size(), '\0');
  data.resize(lzf_compress(zeros.data(), unsigned(zeros.size()), data.data(), unsigned(data.size())));
  std::string packed =
      "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH " + std::to_string(points) + "\nHEIGHT 1\nDATA binary_compressed\n";
  for (const std::size_t size : {data.size(), zeros.size()}) packed.append(reinterpret_cast<const char*>(&size), 4);
  const scratch_file cloud(".pcd", packed + data), file(".ply"), scene(".glb"), rows(".csv", "\n");
  const std::string with =
      " --backend host --model triangles --robot " + q.urdf.path + " --cloud " + cloud.path + " --unfold-limit 90";
  CHECK(parsed(run_command("query --json" + with)).at("state") == "collision");
  const std::string says = cloud.path + ": has 1000000 points, of which ",
                    limit = " MiB would be made here, more than the limit of 90 MiB (--unfold-limit MiB raises it)";
  refuses("query" + with + " --distances " + file.path, says + "125" + limit);
  refuses("query" + with + " --scene " + scene.path, says + "186" + limit);
  refuses("plan" + with + " --configurations " + rows.path, says + "141" + limit);
  CHECK(run_command("plan" + with + "0 --configurations " + rows.path).code == 0);
  // A file of that many bytes is no small one.
  const scratch_file plain(".pcd",
                           "FIELDS x y z\nSIZE 1 1 1\nTYPE U U U\nWIDTH 1000000\nHEIGHT 1\nDATA binary\n" + zeros);
  CHECK(run_command("query --json --backend host --model triangles --robot " + q.urdf.path + " --cloud " + plain.path +
                    " --unfold-limit 1 --distances " + file.path)
            .code == 0);
}

}  // namespace questions_test
