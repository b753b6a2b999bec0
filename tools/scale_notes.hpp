// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Are robot and clouds in the same unit?

#include "asked_clouds.hpp"
#include "robot_bodies.hpp"

/// Adds a note if no point is within 50 m of the robot, or all of them fill less than a hundredth of its size.
void note_scale(const std::vector<seen_points>& clouds, const std::vector<body>& bodies, poses_of poses,
                const clearance::min_distance_result& nearest, std::vector<std::string>& notes);
