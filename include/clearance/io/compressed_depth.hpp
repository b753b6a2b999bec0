// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A ROS CompressedImage that holds depth, as compressed_depth_image_transport writes it: a PNG or RVL image of
// millimetres, or of inverse depths.

#include <clearance/io/error.hpp>
#include <clearance/io/png.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// Either `frame.pixels` are depths (16UC1), or `metres` has one for each of them (32FC1).
struct compressed_depth {
  depth_frame frame;
  std::vector<float> metres;    ///< NaN where nothing was measured.
  std::vector<float> short_by;  ///< By how much less each may be, metres: inverse depths were rounded to whole numbers.
};

/// What the words before and after the semicolon of a message's `format` say.
struct compressed_format {
  bool in_metres = false, rvl = false, headed = false;
};

/// Reads a message's `format`: "16UC1; compressedDepth", "32FC1; compressedDepth rvl", "16UC1; png compressed " and the
/// like; no value for a picture. A picture's bytes are no depth, whatever its topic.
std::optional<compressed_format> depth_format(std::string_view format);

/// Reads a compressed depth image; `file` is its name in errors. Throws std::runtime_error for a picture, and for what
/// is damaged.
compressed_depth read_compressed_depth(std::string_view format, std::string_view bytes, const std::string& file,
                                       const read_limits& limits = {});

}  // namespace clearance::io
