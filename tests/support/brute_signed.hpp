// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's signed distance by definition: the nearest of all triangles, with the sign from a ray's crossings.

#include "support/brute_distances.hpp"
#include "support/closed.hpp"

#include <clearance/make_model.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/solid/winding.hpp>

namespace testing {

inline scene<triangle> triangles_of(const closed_parts& parts) {
  scene<triangle> s{"closed", {}, parts.poses, {}};
  for (const auto& mesh : parts.meshes) {
    const auto corner = [&](std::uint32_t i) {
      const Eigen::Vector3f v = mesh.surface.vertices[i].cast<float>();
      return vec3{v.x(), v.y(), v.z()};
    };
    s.parts.emplace_back();
    for (const auto& t : mesh.surface.triangles)
      s.parts.back().push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
  }
  return s;
}

template <class Source>
clearance::point_distances brute_signed(const closed_parts& parts, const Source& source, const Eigen::Isometry3d& pose,
                                        real d_max) {
  const scene<triangle> s = triangles_of(parts);
  std::vector<clearance::winding<>> solids;
  for (const auto& mesh : parts.meshes) solids.push_back(clearance::make_winding(mesh));
  auto all = brute_distances(s, source, pose, -1, nothing_inside);  // only counts
  bool in = false;
  const auto inside = [&](std::uint32_t k, vec3 q) { return in = solids[k].view().inside(q), false; };
  for_each_pair(s, source, pose, 0, inside, [&](const clearance::pair_distance& pair) {
    const real d = in ? 0 - pair.distance : pair.distance;
    if (!(d <= d_max && d < all.distance[pair.point])) return;
    all.distance[pair.point] = d, all.part[pair.point] = pair.part, all.primitive[pair.point] = pair.primitive;
  });
  return all;
}

/// Before closed meshes, points around, in and on them, and a depth image: what each backend says is by definition.
template <class V, class... On>
void hold_signed_distances(unsigned rounds, const On&... on) {
  using clearance::placed, clearance::signed_distances;
  verdict v;
  for (unsigned round = 0; round < rounds; ++round) {
    const closed_parts parts = closed_scene(60 + round);
    const auto model = clearance::make_model<V>(parts.meshes);
    scene<triangle> s = triangles_of(parts);
    dice d(61 + round);
    s.points = d.points(1500, 0.7);
    for (std::size_t k = 3; k < s.points.size(); k += 11) s.points[k].y = clearance::not_a_number;
    for (int k = 0; k < 60; ++k) {  // on surfaces, as floats can say it
      const auto& own = s.parts[k % s.parts.size()];
      const triangle& t = own[d.below(unsigned(own.size()))];
      const Eigen::Vector3d at = s.poses[k % s.parts.size()] * Eigen::Vector3d(t.a.x, t.a.y, t.a.z);
      s.points.push_back({real(at.x()), real(at.y()), real(at.z())});
    }
    const sources<triangle> all(s);
    const placed cloud{all.span, d.pose(0.1)};
    const placed image{all.raw, all.camera_pose};
    for (const real d_max : {real(0), real(0.1), clearance::infinity}) {
      const auto of_one = brute_signed(parts, cloud.source, cloud.pose, d_max);
      const std::string what = "round " + std::to_string(round) + ", d_max " + std::to_string(d_max);
      const auto deep = std::ranges::count_if(of_one.distance, [](real x) { return x < real(-0.02); });
      v.require(deep > 50, what, ": only ", deep, " points are inside");
      auto of_both = of_one;
      append(of_both, brute_signed(parts, image.source, image.pose, d_max));
      const auto hold = [&](const auto& its, const auto& there) {
        require_same(ask(its, there, s.poses, cloud, signed_distances{d_max, true}), of_one, v, what);
        require_same(ask(its, there, s.poses, std::tuple(cloud, image), signed_distances{d_max}), of_both, v,
                     what + ", two clouds");
      };
      (hold(on, model.on(on)), ...);
    }
  }
}

}  // namespace testing
