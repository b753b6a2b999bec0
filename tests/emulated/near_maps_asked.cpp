// SPDX-License-Identifier: BSD-3-Clause
// Robots with fields and with cells, made where the questions are asked.
#include "emulated/asked.hpp"

#include <clearance/near_maps.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/min_distances.hpp>

#if defined(__CUDA_ARCH__)
#include <clearance/cloud_tree/device_sums.cuh>
#include <clearance/plan/device_engine.cuh>
#include <clearance/pointwise/device_points.cuh>
#endif

namespace emulated_test {

namespace {

template <class V, class P>
void with_both(record& to) {
  dice d(61);
  std::vector<clearance::part<clearance::bvh<V, P>>> parts;
  std::vector<Eigen::Isometry3d> poses;
  for (int k = 0; k < 3; ++k) {
    parts.push_back(clearance::make_part(clearance::build<V>(random_primitives<P>(d, 60, 0.3, 0.2))));
    poses.push_back(d.pose(0.5));
  }
  const clearance::model bare(std::move(parts));
  const auto points = d.points(900, 1);
  const auto fielded = with_fields(here, bare, {.bytes = 1 << 14}).model.on(here);
  std::vector<Eigen::Isometry3d> many = poses;
  for (int c = 0; c < 4; ++c)
    for (const auto& pose : poses) many.push_back(d.pose(0.3) * pose);
  for (const auto& r : ask(here, fielded, many, point_span(points), clearance::min_distances{0.3}).of)
    put(to, "fields, configurations", r);
  const auto close = ask(here, fielded, poses, point_span(points), clearance::in_collision{{0.05}});
  to.put("fields, collision", close.state, close.point, close.part);
  const auto celled = with_cells(here, bare, {.bytes = 1 << 16}).model.on(here);
  for (const double d_max : {0.3, double(clearance::infinity)}) {
    const auto r = ask(here, celled, poses, point_span(points), clearance::distances{d_max, true});
    to.put("cells, distances", r.distance, r.part, r.primitive);
  }
}

void all(record& to) {
  with_both<clearance::sphere, inner_sphere>(to);
  with_both<clearance::aabb, triangle>(to);
}

const asks asked("near_maps", all);

}  // namespace

}  // namespace emulated_test
