// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The frame as its camera sends it, for questions about what it hides.
#include "scene.hpp"

#include <clearance/questions/certain_distance.hpp>
#include <clearance/seen_and_unseen.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/sphere.hpp>

#include <benchmark/benchmark.h>

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
  else if constexpr (requires { r.all; })
    return r.all.distance;
  else
    return r.distance;
}

/// All that is seen 2 m farther away, and a return in every pixel, so that the robot stands before it.
inline std::vector<std::uint16_t> set_back(std::vector<std::uint16_t> pixels) {
  std::uint16_t last = 4000;
  for (auto& d : pixels) d = last = std::uint16_t(d == 0 ? last : d + 2000);
  return pixels;
}

/// Registers a row for both models and each question. `ask(state, model, question, silent)` measures one; `silent`: the
/// frame as it was recorded, and not set back.
template <class Ask, class Finish>
int add_rows(const Ask& ask, const Finish& finish) {
  const auto both = [&](const std::string& name, const auto& q, bool silent = false) {
    finish(benchmark::RegisterBenchmark(("spheres/" + name).c_str(), [=](benchmark::State& state) {
      static const auto model = sphere_model<clearance::sphere>(the_scene());
      ask(state, model, q, silent);
    }));
    finish(benchmark::RegisterBenchmark(("triangles/" + name).c_str(), [=](benchmark::State& state) {
      static const auto model = triangle_model<clearance::aabb>(the_scene());
      ask(state, model, q, silent);
    }));
  };
  both("parts", clearance::min_distance_per_part{});
  both("seen", clearance::min_distance{}), both("unseen", hidden_to_5m), both("unseen_silent", hidden_to_5m, true);
  both("seen_and_unseen", clearance::seen_and_unseen{hidden_to_5m});
  both("certain", clearance::certain_distance{});
  return 0;
}

}  // namespace bench
