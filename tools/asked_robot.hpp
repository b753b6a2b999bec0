// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "progress.hpp"
#include "query_options.hpp"

#include <clearance/io/robot.hpp>

/// The robot of --robot.
clearance::io::robot load_robot(const query_options& asked);

/// One body for each of its parts, packed if the model is of spheres. Notes are what a user should see.
std::vector<body> make_bodies(const query_options& asked, const clearance::io::robot& robot, progress& shown,
                              std::vector<std::string>& notes);
