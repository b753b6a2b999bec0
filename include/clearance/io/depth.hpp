// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A depth image as its file holds it, without a camera.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace clearance::io {

/// Raw 16-bit depths row by row, as in the sensor's file; unit and invalid values are up to the reader.
struct depth_frame {
  std::string name;
  std::vector<std::uint16_t> pixels;
  std::size_t width = 0, height = 0;
};

}  // namespace clearance::io
