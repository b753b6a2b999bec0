// SPDX-License-Identifier: BSD-3-Clause
// Many configurations: a tree over the points, and the search of pairs of nodes.
#include "emulated/asked.hpp"

#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distances.hpp>

#if defined(__CUDA_ARCH__)
#include <clearance/cloud_tree/device_sums.cuh>
#include <clearance/plan/device_engine.cuh>
#endif

namespace emulated_test {

namespace {

using clearance::in_collisions, clearance::min_distances;

template <class V, class P>
void scenes_of(record& to) {
  dice d(31);
  each_scene<V, P>(
      {},
      [&](const auto& s, const auto& model, const auto& clouds, const std::string& name) {
        std::vector<Eigen::Isometry3d> poses;
        for (int c = 0; c < 6; ++c) {
          const Eigen::Isometry3d together = c < 2 ? shifted(0.25 * c * s.size, 0, 0) : d.pose(0.5 * s.size);
          for (const auto& pose : s.poses) poses.push_back(pose * together);
        }
        for (const double d_max : {0.2, double(clearance::infinity)})
          for (const auto& r : ask(here, model, poses, clouds, min_distances{d_max * s.size}).of)
            put(to, name + ", d_max " + std::to_string(d_max), r);
        for (const double margin : {0.0, 0.3}) {
          const auto r = ask(here, model, poses, clouds, in_collisions{{margin * s.size}});
          to.put(name + ", margin " + std::to_string(margin), r.of);
          put(to, name, r.counts);
        }
      },
      600);
}

void all(record& to) {
  scenes_of<clearance::sphere, inner_sphere>(to);
  scenes_of<clearance::aabb, triangle>(to);
}

const asks asked("plans", all);

}  // namespace

}  // namespace emulated_test
