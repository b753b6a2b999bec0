// SPDX-License-Identifier: BSD-3-Clause
// The options of one cloud are given once for it; what clouds, frames and cameras must agree about is compared.
#include "tools/small_png.hpp"
#include "tools/two_boxes.hpp"

#include <fstream>

namespace clouds_test {

using namespace testing;

namespace {

/// A folder that goes with all that is in it.
struct scratch_folder {
  std::string path = fresh_name();
  scratch_folder() { std::filesystem::create_directory(path); }
  static std::string fresh_name() {
    const scratch_file taken(".d");
    return taken.path;
  }
  ~scratch_folder() { std::filesystem::remove_all(path); }
  std::string put(const std::string& name, const std::string& bytes) const {
    std::ofstream(path + '/' + name, std::ios::binary) << bytes;
    return path + '/' + name;
  }
};

/// 16-bit grey; all pixels have this depth.
std::string png_of(std::uint32_t width, std::uint32_t height, std::uint16_t depth) {
  std::string rows;
  for (std::uint32_t v = 0; v < height; ++v) {
    rows += '\0';
    for (std::uint32_t u = 0; u < width; ++u) rows += {char(depth >> 8), char(depth)};
  }
  std::string packed = "\x78\x01";
  std::uint32_t a = 1, b = 0;
  for (const char c : rows) a = (a + std::uint8_t(c)) % 65521, b = (b + a) % 65521;
  for (std::size_t at = 0; at < rows.size(); at += 60000) {
    const std::size_t n = std::min<std::size_t>(60000, rows.size() - at);
    packed += {char(at + n == rows.size()), char(n), char(n >> 8), char(~n), char(~n >> 8)};
    packed += rows.substr(at, n);
  }
  packed += {char(b >> 8), char(b), char(a >> 8), char(a)};
  const auto big = [](std::uint32_t v) { return std::string{char(v >> 24), char(v >> 16), char(v >> 8), char(v)}; };
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big(width) + big(height) + std::string("\x10\0\0\0\0", 5)) +
         chunk("IDAT", packed) + chunk("IEND", "");
}

}  // namespace

TEST_CASE("An option of one cloud that is given twice for it is refused, before its value is read") {
  const two_boxes q;
  const scratch_file other(".xyz", "2 0 0\n"), image(".png", png(1000, 1200)), list(".txt", image.path + '\n'),
      clouds(".txt", other.path + '\n'), rows(".csv", "\n");
  const std::pair<const char*, const char*> options[] = {{"--camera-pose", "1,0,0,0,0,0,1"},
                                                         {"--camera-link", "tool"},
                                                         {"--intrinsics", "100,100,0.5,0"},
                                                         {"--depth-scale", "0.001"},
                                                         {"--cloud-scale", "1"},
                                                         {"--range", "0,5"},
                                                         {"--sensor", "kinect"},
                                                         {"--calibration", "0,0"},
                                                         {"--use-viewpoint", ""},
                                                         {"--zero-is-missing", ""}};
  for (const auto& [option, value] : options) {
    const std::string name = option, given = ' ' + name + ' ' + value;
    const bool flag = *value == '\0';
    for (const std::string& twice : {given + given, given + ' ' + name + (flag ? "" : " nonsense")}) {
      refuses(q.ask + " --cloud " + other.path + twice, name + ": is given twice for " + other.path);
      refuses("query --robot " + q.urdf.path + twice + " --cloud " + other.path,
              name + ": is given twice before the first --cloud");
      refuses("plan --robot " + q.urdf.path + " --configurations " + rows.path + " --cloud " + other.path + twice,
              name + ": is given twice for " + other.path);
      refuses("run --robot " + q.urdf.path + " --frames " + clouds.path + twice,
              name + ": is given twice, and holds for all frames");
    }
  }
  // Each cloud may have its own, and one before all is for those without.
  const auto j = parsed(run_command("query --json --backend host --model triangles --robot " + q.urdf.path +
                                    " --camera-pose 0,0,3,0,0,0,1 --cloud " + q.cloud.path + " --cloud " + other.path +
                                    " --camera-link tool --camera-pose 1,2,3,0,0,0,1"));
  CHECK(j.at("clouds").at(0).at("pose") == nlohmann::json({0, 0, 3, 0, 0, 0, 1}));
  CHECK(j.at("clouds").at(0).at("link").is_null());
  CHECK(j.at("clouds").at(1).at("pose") == nlohmann::json({1, 2, 3, 0, 0, 0, 1}));
  CHECK(j.at("clouds").at(1).at("link") == "tool");
  const auto plan =
      lines(run_command("plan --backend host --model triangles --robot " + q.urdf.path + " --configurations " +
                        rows.path + " --camera-pose 1,2,3,0,0,0,1 --cloud " + other.path));
  CHECK(plan.back().at("clouds").at(0).at("pose") == nlohmann::json({1, 2, 3, 0, 0, 0, 1}));
  for (const std::string& command : {q.ask, "info " + q.urdf.path, "pack --no-cache --spheres 5 " + q.urdf.path})
    refuses(command + " --package a=/tmp --package a=/var", "--package: a is given twice");
}

TEST_CASE("Images of several sizes under one --intrinsics are refused, and a principal point beside them is noted") {
  const two_boxes q;
  const scratch_folder frames;
  const std::string small = frames.put("1.png", png_of(64, 48, 3000)),
                    large = frames.put("2.png", png_of(128, 96, 3000));
  const scratch_file rows(".csv", "\n");
  const std::string robot = " --backend host --model triangles --robot " + q.urdf.path;
  const std::string of_small = " --intrinsics 60,60,31.5,23.5", of_large = " --intrinsics 120,120,63.5,47.5";
  const std::string both = small + " has 64 x 48 pixels, but " + large + " has 128 x 96 pixels";
  for (const std::string& ask :
       {"query" + robot + of_small + " --cloud " + small + " --cloud " + large,
        "plan --configurations " + rows.path + robot + of_small + " --cloud " + small + " --cloud " + large,
        "run" + robot + of_small + " --frames " + frames.path})
    refuses(ask, "--intrinsics: are of one size of images, and " + both);
  const outcome own = run_command("query" + robot + " --cloud " + small + of_small + " --cloud " + large + of_large);
  CHECK(own.code == 0);
  CHECK(own.err.find("principal point") == std::string::npos);
  const auto told = [&](const std::string& image, const std::string& camera) {
    const outcome o = run_command("query" + robot + camera + " --cloud " + image);
    CHECK(o.code == 0);
    return o.err;
  };
  CHECK(told(small, of_small).find("principal point") == std::string::npos);
  CHECK(told(small, of_large).find("the principal point 63.5, 47.5 of --intrinsics is far from the middle") !=
        std::string::npos);
  CHECK(told(small, " --intrinsics 60,60,64,23.5").find("is outside its 64 x 48 pixels") != std::string::npos);
  CHECK(told(large, of_small).find("is far from the middle of its 128 x 96 pixels") != std::string::npos);
  std::filesystem::remove(large);
  const outcome run = run_command("run" + robot + of_large + " --frames " + frames.path);
  CHECK(run.code == 0);
  CHECK(run.err.find("principal point") != std::string::npos);
}

TEST_CASE("Frames of a folder come in the order of their numbers, and what is left out is named") {
  const two_boxes q;
  const scratch_folder folder;
  for (const char* name : {"10.xyz", "9.xyz", "2b.xyz", "2a.xyz", "02.xyz", "x.xyz", "100.xyz"})
    folder.put(name, "1 0 0\n");
  const std::string ask = "run --backend host --model triangles --robot " + q.urdf.path + " --frames ";
  const auto names = [&](const outcome& o) {
    std::string all;
    for (const auto& line : lines(o))
      all += std::filesystem::path(line.at("file").get<std::string>()).stem().string() + ' ';
    return all;
  };
  const outcome all = run_command(ask + folder.path);
  CHECK(names(all) == "02 2a 2b 9 10 100 x ");
  CHECK(all.err.find("left out") == std::string::npos);
  const scratch_folder gaps;
  gaps.put("0.xyz", "1 0 0\n"), gaps.put("1.tiff", "?"), gaps.put("2.xyz", "1 0 0\n"), gaps.put(".hidden", "");
  const outcome some = run_command(ask + gaps.path);
  CHECK((some.code == 0 && names(some) == "0 2 "));
  CHECK(some.err.find("1 of its 3 files are not named like frames (.pcd, .ply, .xyz, .txt, .png) and are left out, "
                      "\"1.tiff\"") != std::string::npos);
  // A single frame, and a list that is none.
  const outcome one = run_command(ask + gaps.path + "/0.xyz");
  CHECK((one.code == 0 && names(one) == "0 "));
  refuses(ask + folder.put("points.txt", "1 0 0\n2 0 0\n"), "lists numbers, not frames");
}

TEST_CASE("--cloud-scale is the unit of a cloud, and what can be no metres gets a note") {
  const two_boxes q;
  const scratch_file metres(".ply",
                            "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty "
                            "double z\nend_header\n0.7 0 0\n0 2 0\n"),
      millimetres(".xyz", "700 0 0\n0 2000 0\n"), tiny(".xyz", "0.3 0 0\n0.3 0.0001 0\n"),
      small(".xyz", "0.3 0 0\n0.3 0.002 0\n"),
      viewed(".pcd",
             "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 "
             "1\nWIDTH 1\nHEIGHT 1\nVIEWPOINT 1000 0 0 1 0 0 0\nPOINTS "
             "1\nDATA ascii\n0 700 0\n");
  const auto ask = [&](const std::string& more) {
    return run_command("query --json --backend host --model triangles --robot " + q.urdf.path + more);
  };
  const auto right = parsed(ask(" --cloud " + metres.path));
  const auto scaled = parsed(ask(" --cloud-scale 0.001 --cloud " + millimetres.path));
  CHECK(scaled.at("distance") == right.at("distance"));
  CHECK(scaled.at("point_xyz") == right.at("point_xyz"));
  CHECK(parsed(ask(" --cloud " + metres.path + " --cloud " + millimetres.path + " --cloud-scale 0.001"))
            .at("points")
            .at("valid") == 4);
  const auto at = parsed(ask(" --cloud-scale 0.001 --use-viewpoint --cloud " + viewed.path)).at("point_xyz");
  CHECK((at.at(0) == 1 && at.at(1).get<double>() == Approx(0.7)));
  const std::string far = "no point is within 50 m of the robot, the nearest is 699.9 m away";
  const outcome wrong = ask(" --cloud " + millimetres.path);
  CHECK(wrong.err.find(far) != std::string::npos);
  CHECK(wrong.err.find("--cloud-scale") != std::string::npos);
  CHECK(ask(" --cloud " + metres.path).err.empty());
  const scratch_file rows(".csv", "\n"), list(".txt", millimetres.path + '\n');
  const std::string robot = " --backend host --model triangles --robot " + q.urdf.path;
  CHECK(run_command("plan --configurations " + rows.path + robot + " --cloud " + millimetres.path).err.find(far) !=
        std::string::npos);
  CHECK(run_command("run --frames " + list.path + robot).err.find(far) != std::string::npos);
  CHECK(lines(run_command("run --cloud-scale 0.001 --frames " + list.path + robot))[0].at("distance") ==
        right.at("distance"));
  CHECK(ask(" --cloud " + tiny.path).err.find("are its meshes in metres?") != std::string::npos);
  CHECK(ask(" --cloud " + small.path).err.find("what is the clouds' unit?") != std::string::npos);
  const scratch_file image(".png", png(1000, 1200));
  refuses("query" + robot + " --cloud " + image.path + " --intrinsics 100,100,0.5,0 --cloud-scale 0.001",
          "--cloud-scale: is for point clouds");
  for (const char* bad : {"0", "-1", "1e10", "nan", "mm"})
    refuses("query" + robot + " --cloud " + metres.path + " --cloud-scale " + bad, "--cloud-scale: ");
}

}  // namespace clouds_test
