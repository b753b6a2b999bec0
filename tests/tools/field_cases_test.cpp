// SPDX-License-Identifier: BSD-3-Clause
// The cases of public bug reports that are about files, each with its right answer (case.md in its folder).
#include "io/robot_folder.hpp"
#include "support/places.hpp"
#include "tools/run_command.hpp"

#include <filesystem>
#include <optional>

namespace field_cases_test {

namespace {

const std::string field = testing::data("/field/");

struct field_case {
  std::string robot, cloud, more;
  std::optional<double> distance;  // none: it is refused,
  std::string says;                // with these words; else a note has them, or there is none
};

void check(const field_case& each) {
  const std::string words = "query --model triangles --backend host --json --robot '" + each.robot + "' --cloud " +
                            field + each.cloud + " " + each.more;
  if (!each.distance) return refuses(words, each.says);
  const outcome o = run_command(words);
  INFO(words << '\n' << o.err);
  REQUIRE(o.code == 0);
  const auto answer = nlohmann::json::parse(o.out);
  CHECK(answer["distance"].get<double>() == Approx(*each.distance).margin(2e-6));
  CHECK(answer["state"] == (*each.distance > 0 ? "free" : "collision"));
  CHECK(answer["notes"].dump().find(each.says) != std::string::npos);
  if (each.says.empty()) CHECK(answer["notes"].empty());
}

}  // namespace

TEST_CASE("The field's cases about files have their right answers", "[data]") {
  if (!std::filesystem::exists(field)) {
    WARN("SKIPPED: no folder " << field);
    return;
  }
  const auto of = [](const std::string& folder, const std::string& name, std::optional<double> distance,
                     const std::string& says = "", const std::string& more = "") {
    return field_case{field + folder + "/" + name + ".urdf", folder + "/p.xyz", more, distance, says};
  };
  const auto box = [](const std::string& cloud, std::optional<double> distance, const std::string& says = "",
                      const std::string& more = "") {
    return field_case{field + "00-box/box.urdf", cloud, more, distance, says};
  };
  const std::string quarter = " --joint j=1.5707963267948966";
  std::vector<field_case> all = {
      {field + "01-glb-y-up/post.urdf", "01-glb-y-up/above.xyz", "", 0.3, "with y up"},
      {field + "01-glb-y-up/post.urdf", "01-glb-y-up/above.xyz", "--gltf-up y", 0.3, ""},
      of("04-scale-one-number", "three", 0.5),
      of("04-scale-one-number", "one", {}, "has the scale"),
      of("04-scale-one-number", "commas", {}, "has the scale"),
      of("05-continuous-velocity-only", "r", 0.45, "", quarter),
      of("07-no-axis", "r", 0.45, "", quarter),
      of("11-continuous-with-limits", "r", 0.45, "", "--joint j=4.71238898038469"),
      of("13-dae-node-matrix", "r", 0.5),
      of("15-stl-length", "solid", 0.5),
      of("15-stl-length", "short", {}, "short.stl"),
      of("15-stl-length", "zero_count", {}, "zero_count.stl"),
      of("15-stl-length", "trailing", 0.5, "bytes after its last triangle"),
      of("15-stl-length", "trailing84", 0.5, "bytes after its last triangle"),
      box("17-pcd-count-0/os.pcd", 0.5),
      box("18-pcd-stored-compressed/literal.pcd", 0.614219),
      box("18-pcd-stored-compressed/stored.pcd", {}, "stored.pcd"),
      box("22-ply-utm-double/utm.ply", 0.5, "", "--base-pose 389123.25,5819456.5,34,0,0,0,1"),
      box("25-gaussian-splat-ply/splat.ply", 0.5),
      {field + "49-sparse-table/rod.urdf", "49-sparse-table/table.xyz", "", 0.049497, ""},
      of("52-floating-root-joint", "r", 0.5, "is taken as the base pose"),
      of("52-floating-root-joint", "r", 0.4, "is taken as the base pose", "--base-pose 0,0,0.1,0,0,0,1"),
      of("54-dae-accessor-counts-floats", "count_is_floats", 0.5, "counts floats"),
      of("54-dae-accessor-counts-floats", "count_is_points", 0.5, "its visual is used"),
      {field + "80-base-on-its-table/arm.urdf", "80-base-on-its-table/table_and_box.xyz", "", 0.0, ""},
      {field + "80-base-on-its-table/arm.urdf", "80-base-on-its-table/table_and_box.xyz", "--exclude-link base",
       0.350895, ""},
      of("83-axis-not-normalised", "r", 0.45, "", "--joint j=0.5")};
  for (const std::string wrong : {"empty", "two", "comma", "nan", "words", "four"})
    all.push_back(of("08-malformed-vector", wrong, {}, "<origin> has the xyz"));
  all.push_back(of("08-malformed-vector", "emptyrpy", {}, "<origin> has the rpy"));
  for (const field_case& each : all) check(each);

  const robot_folder folder;  // two cases write absolute paths
  for (const std::string name : {"03-file-uri", "56-path-of-another-machine"})
    REQUIRE(std::system(("python3 -B '" + field + name + "/make.py' '" + folder.path.string() + "'").c_str()) == 0);
  const std::string made = folder.path.string() + "/";
  for (const std::string name : {"absolute", "spaces", "plain_absolute", "relative_spaces", "upper_package", "percent",
                                 "absolute_one_slash", "backslash"})
    check({made + "03-file-uri/" + name + ".urdf", "03-file-uri/p.xyz", "", 0.5, ""});
  check({made + "03-file-uri/elsewhere.urdf", "03-file-uri/p.xyz", "", {}, "arm_description/meshes/cube.stl"});
  const std::string arm = made + "56-path-of-another-machine/arm_description";
  check({arm + "/urdf/arm.urdf", "56-path-of-another-machine/p.xyz", "--package arm_description=" + arm, 0.5, ""});
  check({arm + "/urdf/arm.urdf", "56-path-of-another-machine/p.xyz", "", 0.5, "--package arm_description=FOLDER"});
}

TEST_CASE("The signs of the field's cube are right", "[data]") {
  if (!std::filesystem::exists(field)) return;
  const robot_folder folder;
  const std::string out = (folder.path / "out.ply").string();
  REQUIRE(run_command("query --model triangles --backend host --robot " + field + "44-cube-sign/r.urdf --cloud " +
                      field + "44-cube-sign/p.xyz --signed --distances " + out)
              .code == 0);
  std::ifstream in(out, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const std::string data = bytes.substr(bytes.find("end_header\n") + 11);
  const double wanted[] = {1.414214, 1.732051, -0.5, 1.414214, 1.732051, 1, -0.25};
  const std::size_t record = data.size() / std::size(wanted);
  for (std::size_t i = 0; i < std::size(wanted); ++i) {
    float distance;
    std::memcpy(&distance, data.data() + i * record + 27, 4);  // after three doubles and three bytes
    CHECK(double(distance) == Approx(wanted[i]).epsilon(1e-6));
  }
}

}  // namespace field_cases_test
