// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A recording as a picture.

#include <clearance/result.hpp>

#include <optional>
#include <string>
#include <vector>

/// What is drawn: `seen` of each frame, and of the others one per frame or none.
struct svg_frames {
  std::vector<clearance::min_distance_result> seen, certain, unseen;
};

/// An SVG picture: the least distance of each frame as a line, in the band of its bracket; `margin` is a dashed line.
/// `certain` is a wider band: the bracket with what is uncertain. `unseen` is a second line and band: the least
/// distance to what no camera sees. Frames about which nothing is known are bars without a line. `name` says whose
/// frames they are. Infinite values end at the picture's edge, as do values far above almost all others; triangles
/// there, and a text, say so.
std::string clearance_svg(const svg_frames& drawn, const std::string& name, std::optional<double> margin);
