// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds of several kinds and sizes, each with its valid points by definition.

#include "support/laws.hpp"
#include "support/random.hpp"

#include <clearance/compacted.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/masked.hpp>
#include <clearance/points/point_span.hpp>

namespace testing {

/// Calls `each(source, points, numbers, what)` for each of them.
template <class F>
void for_each_compacted(const F& each) {
  const auto of = [&](const auto& source, const std::string& what) {
    std::vector<vec3> points;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < source.size(); ++i)
      if (const clearance::sample s = source[i]; s.valid())
        points.push_back(s.position), numbers.push_back(std::uint32_t(i));
    each(source, points, numbers, what + " of " + std::to_string(source.size()));
  };
  dice d(411);
  for (const std::size_t size : {0u, 1u, 31u, 64u, 1000u, 70'001u})
    for (const double lost : {0.0, 0.3, 1.0}) {
      std::vector<vec3> points = d.points(size, 2);
      std::vector<clearance::point_label> labels(size);
      for (std::size_t i = 0; i < size; ++i) {
        if (d.uniform(0, 1) < lost) points[i].y = clearance::not_a_number;
        labels[i] = clearance::point_label(d.below(4));
      }
      of(clearance::point_span(points), "positions");
      of(clearance::masked(clearance::point_span(points), labels.data()), "masked positions");
    }
  std::vector<float> depths(64 * 48);
  for (float& z : depths) z = d.below(3) == 0 ? -float(clearance::infinity) : d.number(0.5, 4);
  of(clearance::depth_image(depths.data(), 64, 48, {60, 60, 31.5, 23.5}), "a depth image");
}

/// What is left of each is its valid points, in their order.
template <class On>
void check_compacted(const On& on) {
  verdict v;
  for_each_compacted([&](const auto& source, const auto& points, const auto& numbers, const std::string& what) {
    const auto require = [&](const auto& there) {
      const auto found = clearance::compacted(on, there);
      v.require(found.numbers == numbers, what, ": ", found.numbers.size(), " are left, and not ", numbers.size());
      v.require(found.points.size() == points.size() &&
                    std::ranges::equal(found.points, points, [](vec3 a, vec3 b) { return same_bytes(a, b); }),
                what, ": some point differs");
    };
    if constexpr (requires { source.labels; }) {  // they have to be where the backend reads them
      const auto labels = on.copy_in(std::span<const clearance::point_label>(source.labels, source.size()));
      require(clearance::masked(source.source, labels.data()));
    } else {
      require(source);
    }
  });
}

}  // namespace testing
