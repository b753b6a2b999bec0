// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A recording for eyes.

#include <clearance/result.hpp>

#include <optional>
#include <span>
#include <string>

/// An SVG picture: the least distance of frame after frame as a line, in the band of its bracket. `margin`: a dashed
/// line, if there is one. Frames of which nothing is known are bars, and have no line. `name` says whose frames they
/// are. What is not finite ends at the picture's edge, and so does what is far above almost all other frames; triangles
/// there, and words, tell of it.
std::string clearance_svg(std::span<const clearance::min_distance_result> frames, const std::string& name,
                          std::optional<double> margin);
