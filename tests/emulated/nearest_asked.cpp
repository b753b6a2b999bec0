// SPDX-License-Identifier: BSD-3-Clause
// All points within a radius of each part, and the nearest of them.
#include "emulated/asked.hpp"

#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/within.hpp>

namespace emulated_test {

namespace {

using clearance::nearest_k, clearance::within;

template <class R>
void put_pairs(record& to, const std::string& what, const R& r) {
  for (const clearance::pair_distance& p : r.pairs) to.put(what, p.cloud, p.point, p.part, p.primitive, p.distance);
  put(to, what, r.counts);
}

template <class V, class P>
void scenes_of(record& to) {
  each_scene<V, P>(
      {},
      [&](const auto& s, const auto& model, const auto& clouds, const std::string& name) {
        for (const double radius : {0.0, 0.2})
          put_pairs(to, name + ", within " + std::to_string(radius),
                    ask(here, model, s.poses, clouds, within{{radius * s.size}}));
        for (const std::size_t k : {1, 7, 400})
          put_pairs(to, name + ", nearest " + std::to_string(k), ask(here, model, s.poses, clouds, nearest_k{k, 0.3}));
      },
      400);
}

/// Prepared: what is known of a frame is of use in the next, or not.
void prepared(record& to) {
  dice d(124);
  scene<inner_sphere> s{"prepared", {}, {}, {}};
  for (int k = 0; k < 5; ++k) {
    s.parts.push_back(random_spheres(d, 30, 0.2, 0.05));
    s.poses.push_back(d.pose(0.5));
  }
  const auto model = model_of<clearance::sphere>(s);
  clearance::query query(here, model, nearest_k{});
  const auto ask = [&](const char* when) {
    const auto points = d.points(1500, 0.6);
    for (const std::size_t k : {3, 500}) put_pairs(to, when, query(s.poses, point_span(points), {k}));
  };
  frame_after_frame(s.poses, ask, [&] { query.forget(); });
}

void all(record& to) {
  prepared(to);
  scenes_of<clearance::sphere, inner_sphere>(to);
  scenes_of<clearance::aabb, triangle>(to);
}

const asks asked("nearest", all);

}  // namespace

}  // namespace emulated_test
