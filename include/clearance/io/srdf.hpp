// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Which parts of a described robot can meet: all but neighbours in its joints, or those that its SRDF file leaves.

#include <clearance/io/limits.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/robot/part_pairs.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// All pairs of a robot's parts but neighbours, which usually touch: a part and the nearest one above it in the tree,
/// unless two prismatic joints or more lie between, as those of a planar or floating joint; and parts that fixed
/// joints alone hold together.
part_pairs pairs_without_neighbours(const robot& described);

/// Removes the pairs of parts that are attached, by number, with what holds them, which no SRDF file knows.
void remove_pairs_of_held(part_pairs& pairs, const robot& described, std::span<const std::size_t> held);

/// The pairs that an SRDF file leaves, and sentences to show to a user, such as that it names a link that is not there.
struct srdf_pairs {
  part_pairs pairs;
  std::vector<std::string> notes;
};

/// Reads which pairs an SRDF file disables, in MoveIt's order: all of a link's by `disable_default_collisions`, then
/// `enable_collisions`, then `disable_collisions`. It alone decides: what it does not name can meet. Throws
/// std::runtime_error with the file's name and line if the file is damaged, is none, or misspells one of these words.
srdf_pairs load_srdf(const std::filesystem::path& srdf, const robot& described, const mesh_limits& limits = {});
/// The same of the file's text, such as ROS's robot_description_semantic; errors call it `name`.
srdf_pairs load_srdf_text(std::string_view text, const std::string& name, const robot& described,
                          const mesh_limits& limits = {});

}  // namespace clearance::io
