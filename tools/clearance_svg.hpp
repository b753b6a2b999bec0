// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A recording as a picture.

#include <clearance/result.hpp>

#include <optional>
#include <span>
#include <string>

/// An SVG picture: the least distance of each frame as a line, in the band of its bracket; `margin` is a dashed line.
/// `unseen`, one per frame or none, is a second line and band: the least distance to what no camera sees.
/// Frames about which nothing is known are bars without a line. `name` says whose frames they are. Infinite values end
/// at the picture's edge, as do values far above almost all others; triangles there, and a text, say so.
std::string clearance_svg(std::span<const clearance::min_distance_result> frames,
                          std::span<const clearance::min_distance_result> unseen, const std::string& name,
                          std::optional<double> margin);
