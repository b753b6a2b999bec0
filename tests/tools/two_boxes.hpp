// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Robots of two boxes that tests of the command ask about.

#include "io/scratch_file.hpp"
#include "tools/run_command.hpp"

#include <filesystem>
#include <string>

namespace testing {

/// A box of 0.2 m at the origin, and a second one 0.5 m above it.
inline const char* const two_boxes_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <joint name="mount" type="fixed"><parent link="base"/><child link="tool"/><origin xyz="0 0 0.5"/></joint>
</robot>
)";

struct two_boxes {
  scratch_file urdf{".urdf", two_boxes_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n0.3 0 0\n"};  // 0.4 m above the tool, and 0.2 m beside the base
  std::string robot = "query --backend host --model triangles --robot " + urdf.path;
  std::string ask = robot + " --json --cloud " + cloud.path;
};

/// The second box is on a slide, and a claw on it turns and is no part.
inline const char* const moving_boxes_text = R"(<robot name="moving">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="claw"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="turn" type="continuous"><parent link="tool"/><child link="claw"/><axis xyz="1 0 0"/></joint>
</robot>
)";

/// The same with a camera on the second box.
inline const char* const boxes_with_eye_text = R"(<robot name="two">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="tool"><collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
  <link name="eye"/>
  <link name="claw"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="tool"/>
    <origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-0.1" upper="1" effort="1" velocity="1"/></joint>
  <joint name="mount" type="fixed"><parent link="tool"/><child link="eye"/><origin xyz="0 0 0.1"/></joint>
  <joint name="turn" type="continuous"><parent link="tool"/><child link="claw"/><axis xyz="1 0 0"/></joint>
</robot>
)";

/// A cube of 0.1 m.
inline const char* const cube_text =
    "v -.05 -.05 -.05\nv .05 -.05 -.05\nv .05 .05 -.05\nv -.05 .05 -.05\nv -.05 -.05 .05\nv .05 -.05 .05\nv .05 .05 "
    ".05\nv -.05 .05 .05\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

struct moving_boxes {
  scratch_file urdf{".urdf", moving_boxes_text};
  scratch_file cloud{".xyz", "5 5 5\n0 0 1.0\nnan 0 0\n0.3 0 0\n"};
  scratch_file cube{".obj", cube_text};
  std::string robot = " --backend host --model triangles --robot " + urdf.path;
  std::string ask = "query --json --cloud " + cloud.path + robot;
  std::string file(const scratch_file& of) const { return std::filesystem::path(of.path).filename().string(); }
};

}  // namespace testing
