// SPDX-License-Identifier: BSD-3-Clause
// `clearance query --zones` and `--distances`.
#include "io/scratch_file.hpp"
#include "tools/run_command.hpp"
#include "tools/small_png.hpp"

#include <clearance/io/ply.hpp>

#include <cmath>
#include <cstring>

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
  CHECK(head.find("property double x\nproperty double y\nproperty double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                  "property float distance\nproperty uint cloud\nproperty uint point\nproperty int part\n") != head.npos);
  std::vector<record> all;
  constexpr std::size_t size = 24 + 3 + 4 * 4;
  REQUIRE((bytes.size() - at - end.size()) % size == 0);
  for (const char* from = bytes.data() + at + end.size(); from < bytes.data() + bytes.size(); from += size) {
    record r{};
    std::memcpy(&r.x, from, 8), std::memcpy(&r.y, from + 8, 8), std::memcpy(&r.z, from + 16, 8);
    r.red = std::uint8_t(from[24]), r.green = std::uint8_t(from[25]), r.blue = std::uint8_t(from[26]);
    std::memcpy(&r.distance, from + 27, 4), std::memcpy(&r.cloud, from + 31, 4), std::memcpy(&r.point, from + 35, 4), std::memcpy(&r.part, from + 39, 4);
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
    const auto two = parsed(run_command(q.ask + " --zones 0.3 --cloud " + other.path + " --volume " + volume)).at("parts").at(0).at("zones").at(0);
    CHECK(two.at("points") == 2);
    CHECK(two.at("nearest").at("cloud") == other.path);
    CHECK(two.at("nearest").at("point") == 0);
    CHECK(two.at("first").at("cloud") == q.cloud.path);
  }
  const std::string text = run_command(q.robot + " --zones 0.1,0.5 --cloud " + q.cloud.path).out;
  CHECK(text.find("zones     the innermost is within 0.5 m\n") != text.npos);
  CHECK(text.find("0.5 m,        2 points, nearest 0.400000 m, point 1; first point 1\n") != text.npos);
  CHECK(text.find("0.1 m,        0 points\n") != text.npos);
  CHECK(run_command(q.robot + " --zones 0.1 --min-points 2 --cloud " + q.cloud.path).out.find("all are empty") != text.npos);
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
    CHECK(run_command(q.robot + " --zones 0.1,0.5 --cloud " + cloud->path).out.find("nothing is known") != std::string::npos);
  }
}

TEST_CASE("--distances writes every valid point where it is in the world, with its distance, number, part and colour") {
  const question q;
  const scratch_file ply(".ply");
  const auto j = parsed(run_command(q.ask + " --distances " + ply.path));
  CHECK(j.at("distances") ==
        nlohmann::json({{"file", ply.path}, {"points", 3}, {"left_out", 1}, {"beyond", 0}, {"d_max", nullptr}, {"blue_at", 1.0}}));
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
  const std::string text = run_command(q.robot + " --cloud " + q.cloud.path + " --d-max 0.3 --distances " + ply.path).out;
  CHECK(text.find(ply.path + ": 3 points, 1 left out, 2 beyond 0.3 m; red at 0 m, blue at 0.3 m\n") != text.npos);
}

TEST_CASE("positions are those of the file, moved by poses in double, and images count their pixels") {
  const question q;
  const scratch_file ply(".ply"), far(".xyz", "447123.0625 5411987.125 251.0\n447123.0625 5411987.125 252.0009765625\n");
  run_command(q.robot + " --base-pose 447123.0625,5411987.125,250,0,0,0,1 --cloud " + far.path + " --distances " + ply.path);
  auto all = records(ply.path);
  REQUIRE(all.size() == 2);
  CHECK(all[0].x == 447123.0625);
  CHECK(all[0].y == 5411987.125);
  CHECK(all[1].z == 252.0009765625);
  CHECK(all[0].distance == Approx(0.4));
  const scratch_file depth(".png", png(0, 1000));
  run_command(q.robot + " --intrinsics 500,500,0,0 --camera-pose 0,0,1,0,0,0,1 --cloud " + depth.path + " --distances " + ply.path);
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
  scratch_file urdf{".urdf", R"(<robot name="r"><link name="a"><collision><geometry><box size="0.2 0.3 0.4"/></geometry></collision></link></robot>)"};
  std::string points;
  for (int i = 0; i < 500; ++i)
    points += std::to_string(0.01 * (i % 83)) + ' ' + std::to_string(-0.02 * (i % 29)) + ' ' + std::to_string(0.003 * (i % 101)) + '\n';
  const scratch_file cloud(".xyz", points), ply(".ply");
  for (const std::string model : {"triangles", "spheres --spheres 200 --no-cache"}) {
    const auto j = parsed(run_command("query --json --backend host --robot " + urdf.path + " --cloud " + cloud.path +
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
  refuses(q.ask + " --d-max 3", "--d-max: is for --distances");
  const scratch_file ply(".ply");
  for (const std::string value : {"0", "-1"}) refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max: must be above 0");
  for (const std::string value : {"nan", "inf", "1,2", "x"}) refuses(q.ask + " --distances " + ply.path + " --d-max " + value, "--d-max");
  refuses(q.ask + " --distances out.xyz", "--distances: out.xyz: its name must end in .ply");
  refuses(q.ask + " --distances /nonexistent/folder/x.ply", "/nonexistent/folder/x.ply");
  refuses(q.ask + " --distances " + ply.path + " --scene " + ply.path, "--distances: is the same file as --scene");
  refuses(q.ask + " --distances " + ply.path + " --scene " + std::filesystem::path(ply.path).parent_path().string() + "/./" +
              std::filesystem::path(ply.path).filename().string(), "--distances: is the same file as --scene");
  const scratch_file input(".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n3 0 0\n");
  refuses(q.robot + " --cloud " + input.path + " --distances " + input.path, input.path + ": is a file that this reads");
  refuses("run --robot x --frames y --zones 0.1", "--zones");
}
