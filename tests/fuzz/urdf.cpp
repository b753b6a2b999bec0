// SPDX-License-Identifier: BSD-3-Clause
#include "io/urdf.hpp"
#include "fuzz/fuzz.hpp"
#include "io/xml_text.hpp"

#include <clearance/io/robot.hpp>

namespace urdf_target {

namespace {

using namespace clearance;

std::vector<Eigen::Vector3d> parts_of(const io::robot& robot) {
  std::vector<Eigen::Vector3d> made;
  for (const auto& part : robot.parts()) {
    const auto mesh = fuzz::corners(part.mesh);
    if (mesh.empty()) fuzz::finding("a part without triangles");
    if (!std::isfinite(part.tessellation_error) || part.tessellation_error < 0) fuzz::finding("an error that is none");
    made.insert(made.end(), mesh.begin(), mesh.end());
    made.emplace_back(double(mesh.size()), part.tessellation_error, double(part.link));
  }
  return made;
}

/// A description; after a zero byte, the file "given", whose name does not say its format.
void read(std::string_view input) {
  const std::string_view urdf = input.substr(0, input.find('\0'));
  fuzz::put("m.urdf", urdf);
  fuzz::put("given", input.substr(std::min(urdf.size() + 1, input.size())));
  fuzz::put("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const io::robot_options options{.packages = {{"p", "."}},
                                  .exclude_links = {},
                                  .tessellation = 0.01,
                                  .shape_triangles = 100,
                                  .all_shape_triangles = 2000,
                                  .limits = fuzz::meshes};
  const auto load = [&] { return io::load_robot("m.urdf", options); };
  std::optional<io::robot> robot;
  if (!fuzz::reads("m.urdf", [&] { robot = load(); })) return;
  for (const std::string& note : robot->notes())
    if (note.size() > io::longest_sentence || note != io::printable(note)) fuzz::finding("no short note: " + note);
  const io::kinematic_tree& tree = robot->kinematics();
  try {
    for (const auto& pose : tree.link_poses(tree.rest()))
      if (!pose.matrix().allFinite()) fuzz::finding("a link that is nowhere");
  } catch (const std::invalid_argument&) {  // joints whose ways cancel, or go too far
  }
  const auto parts = parts_of(*robot);
  const io::xml_element root =
      io::read_xml(urdf.substr(io::declaration_after_blanks(urdf)), "m.urdf", fuzz::meshes, io::xml_prefixes::any);
  fuzz::put("m.urdf", xml_text(root));
  const io::robot again = load();
  if (again.name() != robot->name() || again.kinematics().links() != tree.links() ||
      !fuzz::same(parts, parts_of(again)))
    fuzz::finding("the same document, written anew, is another robot");
}

const fuzz::target urdf("urdf", read, fuzz::damage_xml);

}  // namespace

}  // namespace urdf_target
