// SPDX-License-Identifier: BSD-3-Clause
// Every point's own distance: packets of a warp, walks that warps share.
#include "emulated/asked.hpp"

#include <clearance/questions/distances.hpp>

#if defined(__CUDA_ARCH__)
#include <clearance/pointwise/device_points.cuh>
#endif

namespace emulated_test {

static void put(record& to, const std::string& what, const clearance::point_distances& r) {
  to.put(what, r.distance, r.part, r.primitive);
  put(to, what, r.counts);
}

namespace {

using clearance::distances;

template <class V, class P>
void scenes_of(record& to, const clearance::build_options& how) {
  each_scene<V, P>(
      how,
      [&](const auto& s, const auto& model, const auto& clouds, const std::string& name) {
        for (const double d_max : {-0.05, 0.2, double(clearance::infinity)})
          put(to, name + ", d_max " + std::to_string(d_max),
              ask(here, model, s.poses, clouds, distances{d_max, d_max > 0}));
      },
      400);
}

/// Neighbours and strangers in one block, so that some warps have more to do than others and give points away.
void shared(record& to) {
  dice d(95);
  scene<triangle> s{"shared", {}, {}, {}};
  for (int k = 0; k < 11; ++k) {
    s.parts.push_back(random_triangles(d, 60, 0.3, 0.2));
    s.poses.push_back(d.pose(0.7));
  }
  std::vector<vec3> wall;
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      wall.push_back({1.1f + 0.001f * real(i % 7), 0.02f * real(i - 20), 0.02f * real(j - 20)});
  for (std::size_t i = 0; i < wall.size(); ++i)
    if (i / 20 % 3 == 0) wall[i] = d.point(2);
  const auto model = model_of<clearance::aabb>(s);
  clearance::query query(here, model, distances{});
  const auto ask = [&](const char* when) {
    for (const double d_max : {0.3, double(clearance::infinity)})
      put(to, when, query(s.poses, point_span(wall), {d_max, true}));
  };
  frame_after_frame(s.poses, ask, [&] { query.forget(); });
}

void all(record& to) {
  shared(to);
  scenes_of<clearance::sphere, inner_sphere>(to, {});
  scenes_of<clearance::obb, triangle>(to, {.width = 2});
}

const asks asked("distances", all);

}  // namespace

}  // namespace emulated_test
