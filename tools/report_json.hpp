// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the reports of all commands share.

#include "json_text.hpp"
#include "observations.hpp"
#include "robot_bodies.hpp"

#include <optional>
#include <string>
#include <utility>
#include <vector>

using json = nlohmann::ordered_json;  // keys in the manual's order

inline constexpr const char* reasons[clearance::drop_reasons] = {"none",         "not_finite", "missing",   "saturated",
                                                                 "out_of_range", "masked",     "too_close", "cropped"};

/// The pixel of a point of an image.
std::optional<std::pair<std::uint64_t, std::uint64_t>> pixel(const observation& cloud, std::uint32_t point);

/// State, distance, bracket and witness: `point` of `cloud` (null if there is none).
json witness(const clearance::min_distance_result& r, const observation* cloud, std::uint32_t point,
             const std::vector<body>& bodies);

/// A pose as x,y,z,qx,qy,qz,qw.
json pose_of(const Eigen::Isometry3d& pose);

/// A file of --cloud, and where it is placed: `pose` is that of --camera-pose, in the world or in `link`.
json about_cloud(const observation& cloud);

json counts(const clearance::min_distance_result& r);

/// Rounded to the clock's nanoseconds.
double microseconds(double seconds);
