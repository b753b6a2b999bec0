// SPDX-License-Identifier: BSD-3-Clause
// Points within margins and in zones of parts: the scan of pairs, with answers that end and that count.
#include "emulated/asked.hpp"

#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/zones.hpp>

namespace emulated_test {

static void put(record& to, const std::string& what, const clearance::collision_result& r) {
  to.put(what, r.state, r.cloud, r.point, r.part);
  put(to, what, r.counts);
}
static void put(record& to, const std::string& what, const clearance::zones_result& r) {
  for (const clearance::zone& z : r.zones)
    to.put(what, z.points, z.nearest, z.nearest_cloud, z.nearest_point, z.first_cloud, z.first_point);
  put(to, what, r.counts);
}

namespace {

using clearance::in_collision, clearance::zones;

template <class V, class P>
void scenes_of(record& to, const clearance::build_options& how) {
  each_scene<V, P>(how, [&](const auto& s, const auto& model, const auto& clouds, const std::string& name) {
    for (const double margin : {-0.1, 0.0, 0.02, 0.3})
      put(to, name + ", margin " + std::to_string(margin),
          ask(here, model, s.poses, clouds, in_collision{{margin * s.size}}));
    put(to, name + ", zones", ask(here, model, s.poses, clouds, zones{.thresholds = {0, 0.05 * s.size, 0.5 * s.size}}));
  });
}

/// Prepared, with more points near parts than a block has room for.
void crowd(record& to) {
  dice d(98);
  scene<inner_sphere> s{"crowd", {}, {}, {}};
  for (int k = 0; k < 12; ++k) {
    s.parts.push_back(random_spheres(d, 40, 0.2, 0.05));
    s.poses.push_back(d.pose(0.2));
  }
  const auto model = model_of<clearance::sphere>(s);
  clearance::query near(here, model, in_collision{});
  clearance::query counted(here, model, zones{{0.0}});
  const auto ask = [&](const char* when) {
    auto points = d.points(3500, 0.4);
    for (std::size_t i = 5; i < points.size(); i += 9) points[i].y = clearance::not_a_number;
    for (const double margin : {0.0, 0.001, 0.3}) put(to, when, near(s.poses, point_span(points), {{margin}}));
    put(to, when, counted(s.poses, point_span(points), {.thresholds = {0.02, 0.1, 0.3}}));
  };
  frame_after_frame(s.poses, ask, [&] {
    near.forget();
    counted.forget();
  });
}

void all(record& to) {
  crowd(to);
  scenes_of<clearance::sphere, inner_sphere>(to, {});
  scenes_of<clearance::aabb, triangle>(to, {.width = 4, .leaf_size = 1});
}

const asks asked("collisions", all);

}  // namespace

}  // namespace emulated_test
