// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The laws of what is built before it bounds: fields, and trees over clouds.

#include "bounds/laws.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/cloud_tree/host_tree.hpp>
#include <clearance/near_maps.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/volume/sphere.hpp>

namespace bounds {

/// A field of a few primitives: the computed distance is not below its range (0), nor above (1).
template <class P>
struct field_law {
  static constexpr std::size_t content = 0, numbers = 3;

  std::vector<P> all;
  clearance::field<> its;
  vec3 middle{};
  float size = 1;

  explicit field_law(chance& c) {
    size = c.power(-10, 6), middle = somewhere(c, size);
    std::array<float, about<P>::numbers> x;
    for (std::uint32_t n = 1 + c.below(5); n != 0; --n)
      about<P>::draw(x.data(), middle, size, c), all.push_back(about<P>::make(x.data()));
    const auto part = clearance::make_part(clearance::build<clearance::sphere>(all));
    std::string why_not;
    its = clearance::minimum::sampled_field(clearance::host{.threads = 1}, part, {.bytes = 40960}, why_not);
  }
  void draw(std::array<float, numbers>& x, std::size_t, chance& c) const {
    draw_near(x.data(), 3, middle, size * c.power(-6, 9), c);
  }
  room operator()(const std::array<float, numbers>& x) const {
    room r;
    if (its.empty()) return r;
    const vec3 q = vector_at(x.data());
    real computed = clearance::infinity;
    for (const P& p : all) computed = clearance::min(computed, p.distance(q));
    const clearance::field_range range = its.view()(q);
    const double scale = unit * (std::abs(double(computed)) + its.shape.around.radius) + underflow;
    r.add((double(computed) - double(range.low)) / scale, 0);
    r.add((double(range.high) - double(computed)) / scale, 1);
    return r;
  }
};

/// A tree over a few points: every node's ball holds its points (0), and its box does (1).
struct tree_law {
  static constexpr std::size_t points = 72, content = 0, numbers = 3 * points;  // of two levels

  mutable clearance::host_workers workers{clearance::host{.threads = 1}};
  mutable clearance::cloud_tree::host_tree tree;

  void draw(std::array<float, numbers>& x, std::size_t, chance& c) const {
    const float size = c.power(-20, 20);
    draw_near(x.data(), numbers, somewhere(c, size), size, c);
  }
  room operator()(const std::array<float, numbers>& x) const {
    std::array<vec3, points> all;
    for (std::size_t k = 0; k < points; ++k) all[k] = vector_at(&x[3 * k]);
    clearance::scan::drop_counts dropped{};
    tree.build(workers, clearance::point_span(all), dropped);
    const auto& t = tree.view();
    room r;
    for (std::uint32_t level = 0, span = t.tile; level < t.levels; ++level, span *= t.fan)
      for (std::uint32_t n = 0; n < t.size(level); ++n) {
        const ball b = t.balls[t.begin[level] + n];
        const clearance::extent box = t.boxes[t.begin[level] + n];
        for (std::uint32_t i = n * span; i < std::min(t.count, (n + 1) * span); ++i) {
          const vec3 p = t.points[i].at;
          const double away = reference::length(wider<double>(p) - wider<double>(b.center));
          if (away > 0) r.add((double(b.radius) - away) / (unit * away + underflow), 0);
          r.require(box.lower.x <= p.x && p.x <= box.upper.x && box.lower.y <= p.y && p.y <= box.upper.y &&
                        box.lower.z <= p.z && p.z <= box.upper.z,
                    1);
        }
      }
    r.require(t.count == points, 2);
    return r;
  }
};

}  // namespace bounds
