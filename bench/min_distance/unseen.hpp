// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The frame as its camera sends it, for questions about what it hides.
#include "scene.hpp"

#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/unseen.hpp>

namespace bench {

inline const clearance::unseen hidden_to_5m{.room = {.nearest = 0.4f, .farthest = 5}};

inline const std::vector<std::uint16_t>& depths_of(const scene& s) {
  static const std::vector<std::uint16_t> pixels = [&s] {
    std::vector<std::uint16_t> all;
    for (const auto& p : s.cloud) all.push_back(clearance::is_finite(p) ? std::uint16_t(p.z * 1000 + 0.5f) : 0);
    return all;
  }();
  return pixels;
}
inline auto image_of(const std::uint16_t* pixels) {
  return clearance::depth_image<std::uint16_t>(pixels, 640, 480, {525, 525, 319.5, 239.5});
}
/// The image as a question takes it.
template <class Question, class Image>
auto seen_for(const Image& image) {
  if constexpr (std::is_same_v<Question, clearance::certain_distance>)
    return clearance::uncertain(image, clearance::stereo_noise{525, 0.05f, 0.08f});
  else
    return image;
}
template <class Result>
float least_of(const Result& r) {
  if constexpr (requires { r.nominal; })
    return r.lower;
  else
    return r.all.distance;
}

/// All that is seen 2 m farther away, and a return in every pixel, so that the robot stands before it.
inline std::vector<std::uint16_t> set_back(std::vector<std::uint16_t> pixels) {
  std::uint16_t last = 4000;
  for (auto& d : pixels) d = last = std::uint16_t(d == 0 ? last : d + 2000);
  return pixels;
}

}  // namespace bench
