// SPDX-License-Identifier: BSD-3-Clause
// The least distance, of all parts together and of each, cold and frame after frame.
#include "emulated/asked.hpp"

#include <clearance/questions/min_distance.hpp>
#include <clearance/questions/min_distances_per_part.hpp>

namespace emulated_test {

namespace {

using clearance::min_distance, clearance::min_distance_per_part;

template <class V, class P>
void cold(record& to, const clearance::build_options& how) {
  for (const auto& s : small_scenes<P>()) {
    const sources<P> all(s);
    const auto model = model_of<V>(s, how);
    const auto each = [&](const auto& source, const Eigen::Isometry3d& pose, const char* name) {
      const placed cloud{source, pose};
      const std::string what = s.name + ", " + name;
      put(to, what, ask(here, model, s.poses, cloud, min_distance{}));
      const auto [r, minima] = ask(here, model, s.poses, cloud, min_distance_per_part{});
      put(to, what + ", per part", r);
      for (const auto& m : minima) put(to, what + ", of a part", m);
    };
    each(all.span, s.cloud_pose, "span");
    each(all.doubles, s.cloud_pose, "doubles");
    each(all.raw, all.camera_pose, "16-bit image");
  }
}

/// A prepared question, of two clouds, whose robot and clouds move.
template <class V, class P>
void warm(record& to, std::size_t parts) {
  dice d(7);
  scene<P> s{"warm", {}, {}, {}};
  for (std::size_t k = 0; k < parts; ++k) {
    s.parts.push_back(random_primitives<P>(d, 20, 0.1, 0.05));
    s.poses.push_back(d.pose(1));
  }
  const auto model = model_of<V>(s);
  clearance::query one(here, model, min_distance{});
  clearance::query each(here, model, min_distance_per_part{});
  const std::size_t sizes[] = {900, 1700, 0, 120, 1600, 17};
  std::size_t frame = 0;
  const auto ask = [&](const char* when) {
    const auto near = d.points(sizes[frame % 6], 1), far = d.points(sizes[frame++ % 6] / 2, 3);
    const std::vector clouds{placed{point_span(near), shifted(0, 0, 0.1)}, placed{point_span(far), d.pose(0.2)}};
    const std::string what = std::to_string(parts) + " parts, " + when;
    put(to, what, one(s.poses, clouds));
    const auto& [all, minima] = each(s.poses, clouds);
    put(to, what + ", per part", all);
    for (const auto& m : minima) put(to, what + ", of a part", m);
  };
  for (int k = 0; k < 2; ++k)
    frame_after_frame(s.poses, ask, [&] {
      one.forget();
      each.forget();
    });
}

void all(record& to) {
  for (const std::size_t parts : {1, 10, 40, 130}) warm<clearance::sphere, inner_sphere>(to, parts);
  warm<clearance::obb, triangle>(to, 9);
  cold<clearance::sphere, inner_sphere>(to, {});
  cold<clearance::aabb, triangle>(to, {.width = 4, .leaf_size = 1});
}

const asks asked("min_distance", all);

}  // namespace

}  // namespace emulated_test
