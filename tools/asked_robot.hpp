// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.hpp"
#include "progress.hpp"
#include "query_options.hpp"
#include "robot_bodies.hpp"

#include <clearance/io/packed_part.hpp>
#include <clearance/io/robot.hpp>

/// Returns what `ask()` returns. An error about joints, links or poses names this file.
template <class Ask>
auto about_file(const std::string& file, Ask ask) {
  try {
    return ask();
  } catch (const usage_error&) {
    throw;
  } catch (const std::invalid_argument& error) {
    clearance::io::refuse(file, without_prefix(error.what()));
  }
}

/// An object that a link holds: a mesh, or its spheres.
struct attached_thing {
  std::string name;  // its name as a part, different from all others
  attachment_options from;
  std::size_t link;  // its number in the kinematic tree
  clearance::triangle_mesh mesh;
  std::optional<clearance::io::packed_part> spheres;
};

/// The robot of --robot, and the objects of --attach that it holds: one more part each, after its own.
struct asked_robot {
  clearance::io::robot description;
  std::vector<attached_thing> held;

  /// The held object that is this part; nullptr for the robot's own parts.
  const attached_thing* held_as(std::size_t part) const {
    const std::size_t own = description.parts().size();
    return part < own ? nullptr : &held[part - own];
  }
  /// The number of the link that carries a part.
  std::size_t link_of(std::size_t part) const {
    return held_as(part) ? held_as(part)->link : description.parts()[part].link;
  }
};

/// Reads all files. Notes are shown to the user.
asked_robot load_robot(const query_options& asked, std::vector<std::string>& notes);

/// The configuration of --joints or --joint.
std::vector<double> named_configuration(const query_options& asked, const clearance::io::kinematic_tree& tree);

/// The poses of all links, moved to the base.
std::vector<Eigen::Isometry3d> all_links(const query_options& asked, const clearance::io::robot& robot,
                                         const std::vector<double>& joints);

/// The poses of all parts. Throws if one is out of range for queries; `when` then adds the occasion.
std::vector<Eigen::Isometry3d> placed_links(const query_options& asked, const asked_robot& robot,
                                            const std::vector<double>& joints, const std::string& when = {});

/// One body per part, packed if the model is of spheres. Notes are shown to the user. `fields`: what else the cache is
/// for.
std::vector<body> make_bodies(const query_options& asked, const asked_robot& robot, progress& shown,
                              std::vector<std::string>& notes, field_use fields = field_use::none);
