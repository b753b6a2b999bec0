// SPDX-License-Identifier: BSD-3-Clause
// The order in which kernels read an image's pixels, on the host.
#include "support/catch.hpp"

#include <clearance/cloud_tree/tree_view.hpp>

#include <set>

namespace pixel_order_test {

using clearance::cloud_tree::pixel_order;

TEST_CASE("Every pixel has one place, and those of a tile are neighbours") {
  for (const auto& [width, height] : {std::pair(64u, 64u), {1u, 1u}, {100u, 70u}, {640u, 3u}, {65u, 129u}}) {
    const pixel_order order(width * height, width);
    std::set<std::uint32_t> seen;
    CHECK(order.positions() == (width + 63) / 64 * ((height + 63) / 64) * 4096);
    for (std::uint32_t first = 0; first < order.positions(); first += 8) {
      std::uint32_t left = width, right = 0, top = height, bottom = 0;
      for (std::uint32_t i = first; i < first + 8; ++i) {
        const std::uint32_t n = order(i);
        if (n == clearance::none) continue;
        if (n >= width * height || !seen.insert(n).second) FAIL("place " << i << " has the pixel " << n);
        left = std::min(left, n % width), right = std::max(right, n % width);
        top = std::min(top, n / width), bottom = std::max(bottom, n / width);
      }
      if (left <= right && (right - left > 3 || bottom - top > 1)) FAIL("the tile of place " << first << " is wide");
    }
    CHECK(seen.size() == width * height);
  }
}

TEST_CASE("Pixels that are no whole rows, or too many, have no places") {
  CHECK(pixel_order(10, 3).positions() == 0);
  CHECK(pixel_order(10, 0).positions() == 0);
  CHECK(pixel_order(1u << 26, 1).positions() == 0);
  CHECK(pixel_order((1u << 26) - 64, 1).positions() == (1u << 26) * 64 - 4096);
}

}  // namespace pixel_order_test
