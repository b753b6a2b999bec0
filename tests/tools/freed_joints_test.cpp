// SPDX-License-Identifier: BSD-3-Clause
// A value that is said of a joint that follows another wins, in every subcommand and in every form, with a note.
#include "tools/two_boxes.hpp"

#include <filesystem>

namespace freed_joints_command_test {

namespace {

namespace fs = std::filesystem;

/// Two fingers, the second of which follows the first; a point 0.1 m beside the hand, on the second finger's side.
struct gripper {
  scratch_file urdf{".urdf", R"(<robot name="gripper"><link name="hand"/>
  <link name="left"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <link name="right"><collision><geometry><box size="0.1 0.02 0.1"/></geometry></collision></link>
  <joint name="grip" type="prismatic"><parent link="hand"/><child link="left"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/></joint>
  <joint name="grip2" type="prismatic"><parent link="hand"/><child link="right"/><axis xyz="0 -1 0"/>
    <limit lower="0" upper="0.05" effort="1" velocity="1"/><mimic joint="grip"/></joint></robot>
)"};
  scratch_file cloud{".xyz", "0 -0.1 0\n"};
  fs::path frames = fs::path(cloud.path + "_frames");

  gripper() {
    fs::create_directory(frames);
    fs::copy_file(cloud.path, frames / "1.xyz");
  }
  ~gripper() { fs::remove_all(frames); }

  std::string robot() const { return " --backend host --model triangles --robot " + urdf.path; }
  std::string query() const { return "query --json --cloud " + cloud.path + robot(); }
  std::string run(const std::string& table) const {
    return "run --frames " + frames.string() + " --trajectory " + table + robot();
  }
  std::string plan(const std::string& table) const {
    return "plan --cloud " + cloud.path + " --configurations " + table + robot();
  }
};

constexpr const char* note =
    "joint \"grip2\" has a value of its own here, which wins over what it would follow \"grip\" to by <mimic>";

bool notes(const outcome& o) { return o.err.find(note) != std::string::npos; }

}  // namespace

TEST_CASE("A value of a mimic joint wins over what it would follow to, by --joint and by a column") {
  const gripper g;
  const scratch_file follows(".csv", "grip\n0.01\n"), own(".csv", "grip,grip2\n0.01,0.04\n");
  const auto far = [](const outcome& o) { return lines(o).at(0)["distance"].get<double>(); };
  {
    const outcome o = run_command(g.query() + " --joint grip=0.01");
    CHECK((std::abs(parsed(o)["distance"].get<double>() - 0.08) < 1e-6 && !notes(o)));
    const outcome with = run_command(g.query() + " --joint grip=0.01 --joint grip2=0.04");
    CHECK((std::abs(parsed(with)["distance"].get<double>() - 0.05) < 1e-6 && notes(with)));
  }
  {
    const outcome o = run_command(g.run(follows.path)), with = run_command(g.run(own.path)),
                  fixed = run_command(g.run(follows.path) + " --joint grip2=0.04");
    CHECK((std::abs(far(o) - 0.08) < 1e-6 && !notes(o)));
    CHECK((std::abs(far(with) - 0.05) < 1e-6 && notes(with)));
    CHECK((std::abs(far(fixed) - 0.05) < 1e-6 && notes(fixed)));
  }
  {
    const outcome o = run_command(g.run(own.path) + " --plan " + own.path);
    CHECK((o.code == 0 && notes(o)));
    refuses(g.run(own.path) + " --plan " + follows.path, "has no column for joint \"grip2\"");
  }
}

TEST_CASE("A plan, its ways and what is wrong with joints take a mimic joint's own values, within its limits") {
  const gripper g;
  const scratch_file own(".csv", "grip2,grip\n0,0.01\n0.04,0.01\n"), beyond(".csv", "grip,grip2\n0.01,0.06\n");
  const outcome o = run_command(g.plan(own.path) + " --between");
  const auto rows = lines(o);
  REQUIRE((rows.size() >= 2 && notes(o)));
  CHECK(std::abs(rows[0]["distance"].get<double>() - 0.09) < 1e-6);
  CHECK(std::abs(rows[1]["distance"].get<double>() - 0.05) < 1e-6);
  refuses(g.run(beyond.path), "joint \"grip2\" at 0.06");
  const outcome free = run_command(g.run(beyond.path) + " --ignore-limits");
  CHECK(std::abs(lines(free).at(0)["distance"].get<double>() - 0.03) < 1e-6);
  const scratch_file one(".csv", "grip,grip2\n0.01,0.04\n");
  const outcome wrong = run_command(g.run(one.path) + " --joint-error 0.001");
  CHECK(std::abs(lines(wrong).at(0)["certain"]["lower"].get<double>() - 0.049) < 1e-4);
}

}  // namespace freed_joints_command_test
