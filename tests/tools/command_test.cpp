// SPDX-License-Identifier: BSD-3-Clause
// Runs the built command as a user would.
#include "io/scratch_file.hpp"
#include "support/places.hpp"
#include "tools/run_command.hpp"
#include "tools/small_png.hpp"

namespace command_test {

namespace {

/// A box of 0.2 m on a table, a second one on a slide above it (z of its centre is 0.5 + the joint's value), and a
/// camera on the second.
const char* const robot_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
  <link name="eye"/>
  <link name="extra"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="tool"/><child link="eye"/><origin xyz="0 0 0.1"/></joint>
  <joint name="echo" type="prismatic"><parent link="base"/><child link="extra"/><axis xyz="0 0 1"/><mimic joint="slide"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>
)";

struct scene {
  scratch_file urdf{".urdf", robot_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n"};  // 0.4 m above the tool
  std::string robot = "query --robot " + urdf.path;
  std::string ask = robot + " --cloud " + cloud.path;
};

}  // namespace

TEST_CASE("clearance query finds the nearest point, its part and its bracket") {
  const scene s;
  const outcome o = run_command(s.ask + " --model triangles --json");
  const auto j = parsed(o);
  CHECK(o.code == 0);
  CHECK(j.at("state") == "free");
  CHECK(j.at("distance").get<double>() == Approx(0.4));
  CHECK(j.at("lower").get<double>() <= 0.4);
  CHECK(j.at("upper").get<double>() >= 0.4);
  CHECK(j.at("cloud") == s.cloud.path);
  CHECK(j.at("point") == 1);
  CHECK(j.at("pixel").is_null());
  CHECK(j.at("point_xyz").at(2).get<double>() == Approx(1));
  CHECK(j.at("part") == "tool");
  CHECK(j.at("primitive").is_number());
  CHECK(j.at("nearest_xyz").at(2).get<double>() == Approx(0.6));
  CHECK(j.at("normal").at(2).get<double>() == Approx(1));
  REQUIRE(j.at("parts").size() == 2);
  CHECK(j.at("parts").at(0).at("name") == "base");
  CHECK(j.at("parts").at(0).at("distance").get<double>() == Approx(0.9));
  CHECK(j.at("parts").at(0).at("point") == 1);
  CHECK(j.at("points").at("seen") == 3);
  CHECK(j.at("points").at("valid") == 2);
  CHECK(j.at("points").at("dropped").at("not_finite") == 1);
  CHECK(j.at("model") == "triangles");
  CHECK(j.at("volume") == "obb");
  CHECK(j.at("backend").is_string());
  for (const char* key : {"load", "pack", "build", "upload", "query"})
    CHECK(j.at("seconds").at(key).get<double>() >= 0);
  CHECK(o.err.find("link \"tool\": has no collision geometry") != std::string::npos);

  const outcome text = run_command(s.ask + " --model triangles");
  CHECK(text.code == 0);
  CHECK(text.out.find("free") != std::string::npos);
  CHECK(text.out.find("tool") != std::string::npos);
}

TEST_CASE("both models and all volumes give brackets that meet") {
  const scene s;
  double lower = 0, upper = 1e9;
  for (const std::string model : {"spheres --spheres 300", "triangles"})
    for (const std::string volume : {"sphere", "aabb", "obb"}) {
      const auto j = parsed(run_command(s.ask + " --backend host --json --model " + model + " --volume " + volume));
      lower = std::max(lower, j.at("lower").get<double>());
      upper = std::min(upper, j.at("upper").get<double>());
      CHECK(j.at("volume") == volume);
      CHECK(j.at("part") == "tool");
    }
  CHECK(lower <= upper);
  CHECK(lower <= 0.4);
  CHECK(upper >= 0.4);
}

TEST_CASE("the exit code says free enough, too near, no data or error") {
  const scene s;
  const std::string ask = s.ask + " --model triangles --json";
  CHECK(run_command(ask + " --check 0.39").code == 0);
  CHECK(run_command(ask + " --check 0.4").code == 2);  // lower is rounded down
  CHECK(parsed(run_command(ask + " --check 0.5")).at("check").at("passes") == false);
  const scratch_file empty(".xyz", "# nothing\n");
  const outcome none = run_command(s.robot + " --model triangles --json --check 0.1 --cloud " + empty.path);
  CHECK(none.code == 3);
  const auto j = parsed(none);
  CHECK(j.at("state") == "no_data");
  for (const char* key : {"distance", "cloud", "point", "pixel", "point_xyz", "part", "primitive", "nearest_xyz",
                          "normal", "lower", "upper"})
    CHECK(j.at(key).is_null());
  CHECK(j.at("points").at("seen") == 0);
  CHECK(j.at("parts").at(1).at("distance").is_null());
  CHECK(run_command(s.robot + " --cloud " + empty.path).code == 3);
  CHECK(run_command(ask + " --range 0,0.5").code == 3);
}

TEST_CASE("a point inside a link is a collision at distance 0") {
  const scene s;
  const scratch_file inside(".xyz", "0 0 0.5\n");
  const auto j = parsed(run_command(s.robot + " --model triangles --json --cloud " + inside.path));
  CHECK(j.at("state") == "collision");
  CHECK(j.at("distance") == 0);
  CHECK(j.at("lower") == 0);
  CHECK(j.at("upper") == 0);
  const auto spheres = parsed(run_command(s.robot + " --spheres 200 --json --cloud " + inside.path));
  CHECK(spheres.at("state") == "collision");
  CHECK(spheres.at("distance").get<double>() < 0);
  CHECK(spheres.at("upper") == 0);
  CHECK(run_command(s.robot + " --model triangles --cloud " + inside.path + " --check 0").code == 2);
  refuses(s.robot + " --model triangles --cloud " + inside.path + " --check -0.001",
          "--check: must not be negative (metres)");
}

TEST_CASE("poses, intrinsics, scale and range before the first cloud hold for all, after one for that one") {
  const scene s;
  const scratch_file first(".png", png(0, 1000)), second(".png", png(2000, 65535));
  // World-from-camera: looks up from 0.5 m above the tool, or from where the second pose says.
  const std::string common =
      s.robot + " --model triangles --json --intrinsics 500,500,0,0 --camera-pose 0,0,1.1,0,0,0,1 ";
  auto j = parsed(run_command(common + "--cloud " + first.path + " --cloud " + second.path));
  CHECK(j.at("cloud") == first.path);
  CHECK(j.at("pixel") == nlohmann::json({1, 0}));
  CHECK(j.at("point") == 1);
  CHECK(j.at("distance").get<double>() == Approx(1.5));
  CHECK(j.at("points").at("dropped").at("missing") == 1);
  CHECK(j.at("points").at("dropped").at("saturated") == 1);
  j = parsed(run_command(common + "--cloud " + first.path + " --cloud " + second.path + " --depth-scale 0.0001"));
  CHECK(j.at("cloud") == second.path);
  CHECK(j.at("distance").get<double>() == Approx(0.7));
  j = parsed(
      run_command(common + "--cloud " + first.path + " --cloud " + second.path + " --camera-pose 0,0,-1.1,0,0,0,1"));
  CHECK(j.at("cloud") == second.path);
  CHECK(j.at("distance").get<double>() == Approx(0.3));
  j = parsed(run_command(common + "--range 1.5,inf --cloud " + first.path + " --cloud " + second.path));
  CHECK(j.at("cloud") == second.path);
  CHECK(j.at("points").at("dropped").at("out_of_range") == 1);
  j = parsed(run_command(common + "--cloud " + first.path + " --range 0,0.5 --cloud " + second.path));
  CHECK(j.at("cloud") == second.path);
  // What is said of all has to be for one of them.
  const scratch_file points(".xyz", "0.5 0 0.6\n");
  const std::string robot = s.robot + " --model triangles --json ";
  CHECK(run_command(common + "--zero-is-missing --cloud " + points.path + " --cloud " + first.path).code == 0);
  refuses(common + "--cloud " + points.path, "--intrinsics: is for depth images, and there is none");
  refuses(robot + "--depth-scale 0.001 --cloud " + points.path + " --cloud " + points.path,
          "--depth-scale: is for depth images, and there is none");
  refuses(common + "--use-viewpoint --cloud " + first.path, "--use-viewpoint: is for point clouds, and there is none");
  refuses(common + "--zero-is-missing --cloud " + first.path,
          "--zero-is-missing: is for point clouds, and there is none");
}

TEST_CASE("one file that is given twice can be told apart in every answer") {
  const scene s;
  const scratch_file cloud(".xyz", "0 0 1.0\n");
  const std::string second = cloud.path + " (2)", third = cloud.path + " (3)";
  // The camera is where the file says, 1 m and 0.3 m lower: the second is the nearest to the tool, the third to the
  // base.
  const std::string ask = " --model triangles --backend host --cloud " + cloud.path + " --cloud " + cloud.path +
                          " --camera-pose 0,0,-0.3,0,0,0,1 --cloud " + cloud.path + " --camera-pose 0,0,-0.75,0,0,0,1 ";
  const auto j = parsed(run_command(s.robot + ask + "--json --zones 0.2,5 --nearest 3 --min-support 2@0.1"));
  CHECK(j.at("cloud") == second);
  CHECK(j.at("parts").at(0).at("cloud") == third);
  CHECK(j.at("parts").at(0).at("zones").at(0).at("nearest").at("cloud") == third);
  CHECK(j.at("parts").at(0).at("zones").at(1).at("first").at("cloud") == cloud.path);
  CHECK(j.at("parts").at(1).at("nearest").at(0).at("cloud") == second);
  CHECK(j.at("support").at("nearest_isolated").at("cloud") == second);
  for (int k = 0; k < 3; ++k) CHECK(j.at("clouds").at(k).at("file") == cloud.path);
  CHECK(j.at("clouds").at(2).at("name") == third);
  const std::string text = run_command(s.robot + ask).out;
  CHECK(text.find("cloud     " + second + ", point 0\n") != text.npos);
  const scratch_file rows(".csv", "slide\n0\n");
  for (const std::string more : {"", "--csv"})
    CHECK(run_command("plan --robot " + s.urdf.path + " --configurations " + rows.path + ask + more).out.find(second) !=
          text.npos);
}

TEST_CASE("a camera on a link moves with the joint") {
  const scene s;
  const scratch_file depth(".png", png(0, 300));
  const std::string ask =
      s.robot + " --model triangles --json --camera-link eye --intrinsics 500,500,1,0 --cloud " + depth.path;
  for (const double slide : {-0.05, 0.0, 0.5}) {
    const auto j = parsed(run_command(ask + " --joints " + std::to_string(slide)));
    CHECK(j.at("distance").get<double>() == Approx(0.3));
    CHECK(j.at("point_xyz").at(2).get<double>() == Approx(0.9 + slide));
  }
  CHECK(parsed(run_command(ask + " --joint slide=-.05 --base-pose -1,0,10,0,0,0,1"))
            .at("point_xyz")
            .at(2)
            .get<double>() == Approx(10.85));
}

TEST_CASE("joints are taken by order or by name, and refused with a sentence") {
  const scene s;
  const std::string ask = s.ask + " --model triangles --json";
  CHECK(parsed(run_command(ask + " --joints 0.1")).at("distance").get<double>() == Approx(0.3));
  CHECK(parsed(run_command(ask + " --joint slide=0.1")).at("distance").get<double>() == Approx(0.3));
  CHECK(parsed(run_command(ask + " --ignore-limits --joints -.2")).at("distance").get<double>() == Approx(0.6));
  refuses(ask + " --joints 0.1,0.2", "the robot has 1 movable joints (slide), here are 2 values");
  refuses(ask + " --joints 2", "slide");
  refuses(ask + " --joint slide=2", "slide");
  refuses(ask + " --joint mount=0", "mount");
  refuses(ask + " --joint nobody=0", "nobody");
  refuses(ask + " --joint slide", "\"slide\" is not of the form name=value");
  refuses(ask + " --joint slide=fast", "\"fast\" is not a number");
  refuses(ask + " --joint slide=0 --joint slide=0", "slide is given twice");
  refuses(ask + " --joints 0 --joint slide=0", "cannot be mixed");
}

TEST_CASE("wrong usage is one sentence and exit code 1") {
  const scene s;
  const scratch_file depth(".png", png(1000, 1000)), shallow(".png", png(10, 10, 8)), cut(".pcd", "VERSION .7\n"),
      nothing(".ply", "");
  refuses("", "subcommand");
  refuses("quarry", "quarry: there is no such subcommand");
  refuses("query", "--robot is required");
  refuses(s.robot, "--cloud is required");
  refuses(s.ask + " --colour red", "--colour");
  refuses(s.ask + " --robot x", "--robot");
  refuses(s.ask + " --model cubes", "--model: \"cubes\" is not spheres or triangles");
  refuses(s.ask + " --volume box", "--volume: \"box\" is not sphere, aabb or obb");
  refuses(s.ask + " --backend gpu", "--backend: \"gpu\" is not host or device");
  refuses(s.ask + " --geometry both", "--geometry: \"both\" is not collision or visual");
  refuses(s.ask + " --spheres 0", "--spheres: \"0\" is not a whole number from 1");
  refuses(s.ask + " --spheres -5", "--spheres: \"-5\" is not a whole number from 1");
  refuses(s.ask + " --spheres 1e3", "is not a whole number");
  refuses(s.ask + " --check near", "--check: \"near\" is not a number");
  refuses(s.ask + " --check nan", "--check: \"nan\" is not a finite number");
  refuses(s.ask + " --check -1", "--check: must not be negative (metres)");
  for (const std::string of_spheres : {"--spheres 5", "--cache /tmp", "--no-cache"})
    refuses(s.ask + " --model triangles " + of_spheres,
            of_spheres.substr(0, of_spheres.find(' ')) + ": is for --model spheres");
  refuses(s.ask + " --base-pose 0,0,0,0,0,0,2", "the quaternion has length 2");
  refuses(s.ask + " --camera-pose 0,0,0,0,0,0,0", "the quaternion has length 0");
  refuses(s.ask + " --camera-pose 0,0,0,1", "--camera-pose: needs 7 numbers, x,y,z,qx,qy,qz,qw; here are 4");
  refuses(s.ask + " --camera-pose 0,0,inf,0,0,0,1", "\"inf\" is not a finite number");
  refuses(s.ask + " --camera-link elbow", "elbow");
  refuses(s.ask + " --range 2,1", "--range: needs 0 <= near < far");
  refuses(s.ask + " --range 1", "--range: needs 2 numbers");
  refuses(s.ask + " --intrinsics 1,1,0,0", "--intrinsics: is for depth images");
  refuses(s.robot + " --cloud " + depth.path, "needs --intrinsics fx,fy,cx,cy");
  refuses(s.robot + " --cloud " + depth.path + " --intrinsics 0,1,0,0", "must be above 0");
  refuses(s.robot + " --cloud " + depth.path + " --intrinsics 1,1,0,0 --depth-scale 0", "must be above 0");
  refuses(s.robot + " --cloud " + shallow.path + " --intrinsics 1,1,0,0",
          "must be a 16-bit grey PNG, this one is 8-bit grey");
  refuses(s.robot + " --cloud " + cut.path, cut.path + ": the PCD header has no DATA entry");
  refuses(s.robot + " --cloud " + nothing.path, nothing.path + ": is empty (0 bytes)");
  refuses(s.robot + " --cloud nowhere.pcd", "nowhere.pcd: there is no such file");
  refuses(s.robot + " --cloud cloud.las", "cloud.las: is no point cloud by its name");
  refuses("query --robot nowhere.urdf --cloud " + s.cloud.path, "nowhere.urdf");
  refuses(s.ask + " --exclude-link nobody", "nobody");
  refuses(s.ask + " --exclude-link base --exclude-link tool", "no link");
  refuses(s.ask + " --use-viewpoint", "has no VIEWPOINT");
  refuses(s.ask + " --model triangles --scene /nonexistent/folder/x.glb", "/nonexistent/folder/x.glb");
  CHECK(run_command("query --help").code == 0);
  CHECK(run_command("query --help").out.find("Exit codes: 0 done; 1 ") != std::string::npos);
  CHECK(run_command("--version").code == 0);
}

TEST_CASE("a quaternion of nearly unit length is normalised") {
  const scene s;
  const auto j = parsed(run_command(s.ask + " --model triangles --json --camera-pose 0,0,0,0,0,0,1.0009"));
  CHECK(j.at("distance").get<double>() == Approx(0.4));
}

TEST_CASE("(0,0,0) is a point unless the user says otherwise, and many are mentioned") {
  const scene s;
  for (const std::string away : {"", "5000000"}) {  // far from the world's origin, too
    const scratch_file zeros(".xyz", "0 0 0\n" + (away.empty() ? "0" : away) + " 0 1.0\n");
    const std::string ask = s.robot + " --model triangles --json --cloud " + zeros.path;
    const outcome plain = run_command(ask);
    CHECK(parsed(plain).at("state") == "collision");
    CHECK(plain.err.find("1 of 2 points are (0,0,0)") != std::string::npos);
    const outcome dropped = run_command(ask + " --zero-is-missing");
    CHECK(parsed(dropped).at("points").at("dropped").at("missing") == 1);
    CHECK(parsed(dropped).at("points").at("dropped").at("not_finite") == 0);
    CHECK(parsed(dropped).at("point") == 1);
  }
}

TEST_CASE("a cloud in map coordinates is as exact as its numbers") {
  const scene s;
  const scratch_file far(".xyz", "447123.0625 5411987.125 251.0\n447123.0625 5411987.125 251.001\n");
  const auto j = parsed(run_command(
      s.robot + " --model triangles --json --base-pose 447123.0625,5411987.125,250,0,0,0,1 --cloud " + far.path));
  CHECK(j.at("point") == 0);
  CHECK(std::abs(j.at("distance").get<double>() - 0.4) < 1e-5);
  CHECK(std::abs(j.at("point_xyz").at(1).get<double>() - 5411987.125) < 1e-6);
}

TEST_CASE("a PCD's viewpoint is reported, and applied only when asked") {
  const scene s;
  const scratch_file pcd(
      ".pcd",
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nVIEWPOINT 0 0 0.2 1 0 0 0\nDATA ascii\n0 0 1\n");
  const std::string ask = s.robot + " --model triangles --json --cloud " + pcd.path;
  const outcome plain = run_command(ask);
  CHECK(parsed(plain).at("distance").get<double>() == Approx(0.4));
  CHECK(parsed(plain).at("clouds").at(0).at("viewpoint") == nlohmann::json({0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 1.0}));
  CHECK(plain.err.find("--use-viewpoint") != std::string::npos);
  CHECK(parsed(run_command(ask + " --use-viewpoint")).at("distance").get<double>() == Approx(0.6));
}

TEST_CASE("an excluded link is no part, and --scene writes a glTF file") {
  const scene s;
  const scratch_file glb(".glb");
  const auto j = parsed(run_command(s.ask + " --model triangles --json --exclude-link tool --scene " + glb.path));
  CHECK(j.at("part") == "base");
  CHECK(j.at("parts").size() == 1);
  std::ifstream in(glb.path, std::ios::binary);
  std::string magic(4, '\0');
  in.read(magic.data(), 4);
  CHECK(magic == "glTF");
}

TEST_CASE("clearance pack fills a mesh and writes its spheres") {
  // A box of 0.2 x 0.2 x 0.2 with its top left open.
  const scratch_file mesh(
      ".obj",
      "v -.1 -.1 -.1\nv .1 -.1 -.1\nv .1 .1 -.1\nv -.1 .1 -.1\nv -.1 -.1 .1\nv .1 -.1 .1\nv .1 .1 .1\nv -.1 .1 .1\n"
      "f 4 3 2 1\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  const scratch_file csv(".csv");
  const outcome o = run_command("pack " + mesh.path + " --spheres 50 --json --out " + csv.path);
  CHECK(o.code == 0);
  CHECK(o.err.empty());  // no progress into a pipe
  const auto j = parsed(o);
  CHECK(j.at("spheres") == 50);
  CHECK(j.at("stopped_by") == "count");
  CHECK(j.at("fill").get<double>() > 0.5);
  CHECK(j.at("fill").get<double>() < 1);
  CHECK(j.at("gap").get<double>() > 0);
  CHECK(j.at("radius_max").get<double>() == Approx(0.1));
  CHECK(j.at("radius_min").get<double>() > 0);
  CHECK(j.at("caps").at("loops") == 1);
  CHECK(j.at("caps").at("area").get<double>() == Approx(0.04));
  CHECK(j.at("seconds").is_number());
  std::ifstream in(csv.path);
  std::string line;
  std::getline(in, line);
  CHECK(line == "x,y,z,r");
  int rows = 0;
  while (std::getline(in, line)) rows += std::count(line.begin(), line.end(), ',') == 3;
  CHECK(rows == 50);
  CHECK(run_command("pack " + mesh.path + " --spheres 5").out.find("fill") != std::string::npos);
  const scratch_file flat(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), empty(".stl", "");
  refuses("pack " + flat.path + " --spheres 5", flat.path + ": ");
  refuses("pack " + empty.path + " --spheres 5", "is empty (0 bytes)");
  refuses("pack nowhere.stl --spheres 5", "nowhere.stl: there is no such file");
  refuses("pack " + mesh.path, "--spheres is required");
  refuses("pack " + mesh.path + " --spheres many", "\"many\" is not a whole number");
  refuses("pack " + mesh.path + " --spheres 5 --out /nonexistent/folder/s.csv", "/nonexistent/folder/s.csv");
}

TEST_CASE("clearance demo agrees with itself") {
  const outcome o = run_command("demo --spheres 100");
  INFO(o.out);
  CHECK(o.code == 0);
  CHECK(o.out.find("Witnesses within a model are the same. Brackets meet.") != std::string::npos);
  CHECK(o.err.empty());
}

TEST_CASE("a real depth image and the point cloud of the same frame give the same answer", "[data]") {
  const std::string data = testing::data();
  if (!std::filesystem::exists(data)) {
    WARN("SKIPPED: no folder " << data);
    return;
  }
  const std::string frame = data + "/clouds/kinect_seq/frame_20121214T142255.814212";
  const std::string png = " --intrinsics 525,525,320,240 --cloud " + frame + "_depth.png",
                    pcd = " --cloud " + frame + ".pcd";
  for (const std::string robot : {"kuka_lwr_kresse/kuka.urdf", "ur5e/ur5e.urdf"}) {
    const std::string ask =
        "query --json --camera-pose -0.8,0.6,1.5,0,0.92388,0,0.38268 --robot " + data + "/robots/" + robot;
    double lower = 0, upper = 1e9;
    for (const std::string model : {" --model spheres --spheres 200", " --model triangles"}) {
      const auto a = parsed(run_command(ask + model + png)), b = parsed(run_command(ask + model + pcd));
      CHECK(std::abs(a.at("distance").get<double>() - b.at("distance").get<double>()) < 1e-6);
      CHECK(a.at("points").at("valid") == 271575);
      CHECK(b.at("points").at("valid") == 271575);
      CHECK(a.at("points").at("dropped").at("missing") == 35625);
      CHECK(b.at("points").at("dropped").at("not_finite") == 35625);
      CHECK(a.at("state") != "no_data");
      CHECK(a.at("pixel") == nlohmann::json({a.at("point").get<int>() % 640, a.at("point").get<int>() / 640}));
      CHECK(b.at("pixel").is_null());
      CHECK(b.at("clouds").at(0).at("viewpoint").is_array());
      lower = std::max(lower, a.at("lower").get<double>());
      upper = std::min(upper, a.at("upper").get<double>());
    }
    CHECK(lower <= upper);
  }
}

TEST_CASE("clearance info says what it is and what it runs on") {
  const outcome o = run_command("info --json");
  CHECK(o.code == 0);
  const auto j = parsed(o);
  CHECK(j.at("version").is_string());
  CHECK((j.at("device").is_null() || j.at("backend") == "device"));
  CHECK(run_command("info").out.find("host") != std::string::npos);
  if (j.at("device").is_null()) {
    const scene s;
    refuses(s.ask + " --backend device", "--backend: device is not possible");
    refuses("pack " + s.urdf.path + " --spheres 5 --backend device", "--backend: device is not possible");
  }
}

}  // namespace command_test
