// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Frames for a prepared question, one after another.

#include "support/brute_pairs.hpp"
#include "support/product.hpp"

#include <clearance/volume/sphere.hpp>

namespace testing {

/// A robot moves among clouds that grow and shrink. Some frames have more clouds, one has no point.
struct moving_frames {
  static constexpr std::size_t count = 6;
  static constexpr std::size_t sizes[count] = {3000, 20000, 0, 500, 30000, 17};

  dice d;
  scene<inner_sphere> s;
  std::size_t number = 0;
  std::vector<std::vector<vec3>> points;

  moving_frames(int parts, unsigned seed) : d(seed) {
    for (int part = 0; part < parts; ++part) {
      s.parts.push_back(random_spheres(d, 20, 0.1, 0.03));
      s.poses.push_back(d.pose(1));
    }
    see(sizes[0]);
  }

  bool there() const { return number < count; }
  void next() {
    if (++number >= count) return;
    s.poses[number % s.poses.size()] = d.pose(1);
    see(sizes[number]);
  }
  /// Makes a cloud of `n` points, one of half as many, and in every other frame one of a few more.
  void see(std::size_t n) {
    points = {d.points(n, 1.5), d.points(n / 2, 1.5)};
    if (number % 2 == 1) points.push_back(d.points(10, 1.5));
    if (n > 100) points[0][n / 3].y = clearance::not_a_number;
  }
  clouds here() const {
    clouds all;
    for (const auto& p : points) all.push_back({clearance::point_span(p), shifted(0.1 * double(all.size()), 0, 0)});
    return all;
  }

  auto model() const { return make_model<clearance::sphere>(s, {}, clearance::wrapped{}); }
};

/// A frame's points where `on` reads them.
template <class On>
struct frame_there {
  std::vector<typename On::template buffer<vec3>> points;
  clouds all;

  frame_there(const On& on, const moving_frames& f) : all(f.here()) {
    for (std::size_t c = 0; c < all.size(); ++c) {
      points.push_back(on.copy_in(std::span<const vec3>(f.points[c])));
      all[c].source = clearance::point_span(points[c].data(), points[c].size());
    }
  }
  std::size_t count() const {
    std::size_t n = 0;
    for (const auto& cloud : all) n += cloud.source.size();
    return n;
  }
};

/// Room for `n` values that `on` writes, each of which is `before` until then.
template <class T, class On>
typename On::template buffer<T> room_on(const On& on, std::size_t n, const T& before = {}) {
  return on.copy_in(std::span<const T>(std::vector<T>(n, before)));
}

}  // namespace testing
