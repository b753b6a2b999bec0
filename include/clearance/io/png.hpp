// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Reads depth images from PNG files.

#include <clearance/io/error.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// Raw 16-bit depths row by row, as in the sensor's file; unit and invalid values are up to the reader.
struct depth_frame {
  std::string name;
  std::vector<std::uint16_t> pixels;
  std::size_t width = 0, height = 0;
};

/// Reads a PNG file from memory; `file` is its name in the frame and in errors.
depth_frame read_png(std::string_view bytes, const std::string& file, const read_limits& limits = {});

/// Reads a depth frame from a 16-bit grey PNG. Throws std::runtime_error for any other PNG, and for a damaged or
/// truncated one.
depth_frame load_png(const std::string& file, const read_limits& limits = {});

}  // namespace clearance::io
