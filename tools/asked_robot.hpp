// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "command_line.hpp"
#include "progress.hpp"
#include "query_options.hpp"

#include <clearance/io/robot.hpp>

/// What `ask()` returns; what it refuses about joints, links and poses is said of this file.
template <class Ask>
auto about_file(const std::string& file, Ask ask) {
  try {
    return ask();
  } catch (const usage_error&) {
    throw;
  } catch (const std::invalid_argument& error) {
    std::string why = error.what();
    if (why.starts_with("clearance: ")) why.erase(0, 11);
    clearance::io::refuse(file, why);
  }
}

/// The robot of --robot.
clearance::io::robot load_robot(const query_options& asked);

/// The robot's poses, moved by the base; throws if one of its links is where no query can be. `when` says more of it.
std::vector<Eigen::Isometry3d> placed_links(const query_options& asked, const clearance::io::robot& robot,
                                            const std::vector<double>& joints, const std::string& when = {});

/// One body for each of its parts, packed if the model is of spheres. Notes are what a user should see.
std::vector<body> make_bodies(const query_options& asked, const clearance::io::robot& robot, progress& shown,
                              std::vector<std::string>& notes);
