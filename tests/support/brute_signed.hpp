// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's signed distance by definition: the nearest of all triangles, with the sign from a ray's crossings.

#include "support/brute_distances.hpp"
#include "support/closed.hpp"

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

}  // namespace testing
