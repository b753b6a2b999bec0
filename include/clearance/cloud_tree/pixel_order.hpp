// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// An order of an image's pixels in which neighbours are neighbours in memory.

#include <clearance/point_source.hpp>
#include <clearance/result.hpp>

namespace clearance::cloud_tree {

/// Squares of 64 x 64 pixels one after another, row by row, and the pixels of each along a Z-curve: eight pixels are a
/// tile of 4 x 2, eight tiles a square, and so on. Places beyond the image's edges have no number.
struct pixel_order {
  static constexpr bool counts = true;  ///< Invalid points were not counted before.
  static constexpr std::uint32_t bits = 6, side = 1 << bits;

  std::uint32_t width = 0, height = 0, squares = 0;  ///< `squares`: in a row.

  pixel_order() = default;
  /// Has no positions if the pixels are not whole rows, or if there are more places than numbers.
  pixel_order(std::uint32_t pixels, std::uint32_t columns) {
    if (columns == 0 || pixels % columns != 0) return;
    const std::uint64_t across = (std::uint64_t(columns) + side - 1) / side,
                        down = (std::uint64_t(pixels / columns) + side - 1) / side;
    if (across * down >> (32 - 2 * bits) == 0)
      width = columns, height = pixels / columns, squares = std::uint32_t(across);
  }
  std::uint32_t positions() const { return squares * ((height + side - 1) / side) * side * side; }

  CLEARANCE_HD std::uint32_t operator()(std::uint32_t i) const {
    const std::uint32_t square = i >> 2 * bits;
    const std::uint32_t x = square % squares * side + every_other(i), y = square / squares * side + every_other(i >> 1);
    return x < width && y < height ? y * width + x : none;
  }

  template <unsigned>
  CLEARANCE_HD std::uint32_t of_block(std::uint32_t i) const {
    return (*this)(i);
  }

 private:
  CLEARANCE_HD static std::uint32_t every_other(std::uint32_t i) {
    i &= 0x555, i = (i | i >> 1) & 0x333, i = (i | i >> 2) & 0x70f;
    return (i | i >> 4) & (side - 1);
  }
};

}  // namespace clearance::cloud_tree
