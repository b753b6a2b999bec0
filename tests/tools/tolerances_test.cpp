// SPDX-License-Identifier: BSD-3-Clause
// How far the surface of each part may be from the model is told, and widens only that part's distances.
#include "tools/two_boxes.hpp"

namespace tolerances_test {

using namespace testing;

namespace {

/// A box, and above it a drum, which is tessellated; the box is shown as a cylinder.
inline const char* const box_and_drum_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
    <visual><geometry><cylinder radius="0.1" length="0.2"/></geometry></visual></link>
  <link name="drum"><collision><geometry><cylinder radius="0.3" length="0.3"/></geometry></collision></link>
  <joint name="mount" type="fixed"><parent link="base"/><child link="drum"/><origin xyz="0 0 2"/></joint>
</robot>
)";

}  // namespace

TEST_CASE(
    "A part's tolerance stands beside how its inside is known, in JSON and in text, and for the geometry asked for") {
  const scratch_file urdf(".urdf", box_and_drum_text), cloud(".xyz", "0.3 0 0\n0.3 0 0.1\n");
  const auto info = [&](const std::string& more) {
    return parsed(run_command("info --json " + urdf.path + more)).at("parts");
  };
  const std::string ask = "query --backend host --robot " + urdf.path + " --cloud " + cloud.path;
  for (const std::string geometry : {"", " --geometry collision", " --geometry visual"}) {
    const auto told = info(geometry);
    const auto parts = parsed(run_command(ask + " --json --model triangles" + geometry)).at("parts");
    const outcome text = run_command(ask + " --model triangles" + geometry);
    for (int k : {0, 1}) {
      CHECK(parts.at(k).at("inside") == told.at(k).at("inside"));
      CHECK(parts.at(k).at("tolerance") == told.at(k).at("tolerance"));
    }
    CHECK((told.at(0).at("tolerance") == 0) == (geometry != " --geometry visual"));
    CHECK(told.at(1).at("tolerance") > 0);
    CHECK(text.out.find(", to within 0.0") != std::string::npos);
  }
  const auto spheres = parsed(run_command(ask + " --json --spheres 30 --no-cache")).at("parts");
  CHECK(spheres.at(1).at("tolerance") >= info("").at(1).at("tolerance"));
  refuses("info " + urdf.path + " --geometry both", "--geometry: \"both\" is not collision or visual");
  refuses("info " + cloud.path + " --geometry visual", "--geometry: is for robots");
  CHECK(run_command("info " + urdf.path + " --geometry visual").out.find("to within 0.000") != std::string::npos);
}

TEST_CASE("A --check that passes in query passes in run: another part's tolerance is not in it") {
  const scratch_file urdf(".urdf", box_and_drum_text), cloud(".xyz", "0.3 0 0\n0.3 0 0.1\n");
  const scratch_file list(".txt", cloud.path + '\n');
  for (const std::string model : {" --model triangles", " --spheres 30 --no-cache"}) {
    const std::string robot = " --backend host --robot " + urdf.path + model;
    const auto j = parsed(run_command("query --json --cloud " + cloud.path + robot));
    const auto frame = lines(run_command("run --frames " + list.path + robot))[0];
    CHECK(frame.at("lower") == j.at("lower"));
    CHECK(frame.at("upper") == j.at("upper"));
    const double lower = j.at("lower").get<double>();
    for (const double margin : {lower - 1e-6, lower + 1e-6}) {
      const std::string check = " --check " + std::to_string(margin);
      const int expected = margin < lower ? 0 : 2;
      CHECK(run_command("query --cloud " + cloud.path + robot + check).code == expected);
      CHECK(run_command("run --frames " + list.path + robot + check).code == expected);
    }
  }
  const auto exact = parsed(
      run_command("query --json --model triangles --backend host --robot " + urdf.path + " --cloud " + cloud.path));
  CHECK(exact.at("lower").get<double>() > 0.2 - 2e-5);  // floats lose less, and the drum's would be 3e-4
}

}  // namespace tolerances_test
