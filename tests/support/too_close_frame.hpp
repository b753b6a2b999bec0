// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A ball in front of a wall, as a depth image in which some pixels can be -inf.

#include "support/random.hpp"

#include <clearance/points/depth_image.hpp>
#include <clearance/points/ray_image.hpp>

namespace testing {

struct too_close_frame {
  std::vector<float> pixels = std::vector<float>(64 * 48, 3.0f);
  std::vector<clearance::ray> rays;

  explicit too_close_frame(std::size_t near, std::size_t nowhere = 0, std::size_t beyond = 0) {
    for (std::size_t k = 0; k < near; ++k) pixels[700 + 5 * k] = -clearance::infinity;
    for (std::size_t k = 0; k < nowhere; ++k) pixels[701 + 5 * k] = clearance::not_a_number;
    for (std::size_t k = 0; k < beyond; ++k) pixels[702 + 5 * k] = clearance::infinity;
    for (int v = 0; v < 48; ++v)
      for (int u = 0; u < 64; ++u) rays.push_back({(float(u) - 31.5f) / 60, (float(v) - 23.5f) / 60});
  }
  clearance::depth_image<float> image() const { return {pixels.data(), 64, 48, {60, 60, 31.5, 23.5}}; }
  clearance::ray_image<float> with_rays() const { return {pixels.data(), rays.data(), 64, 48}; }
};

inline const std::vector<std::vector<inner_sphere>> ball_before_it{{{{0, 0, 1}, 0.2f}}};

}  // namespace testing
