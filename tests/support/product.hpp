// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every width x fit x traversal x point source for one primitive and one volume, compared with brute force bit for bit.

#include "support/brute_force.hpp"
#include "support/scenes.hpp"

#include <clearance/bvh/build.hpp>
#include <clearance/traversal/recursive.hpp>
#include <clearance/traversal/stack.hpp>

namespace testing {

template <class P>
std::vector<brute_part<P>> brute_parts(const scene<P>& s) {
  std::vector<brute_part<P>> parts;
  for (const auto& primitives : s.parts) {
    const ball around = clearance::enclosing_ball(std::span<const P>(primitives));
    parts.push_back({primitives, {around.center, around.radius, 0, 0}, {}});
  }
  return parts;
}

template <class V, class P, class Fit>
auto make_model(const scene<P>& s, const clearance::build_options& options, Fit fit) {
  std::vector<clearance::part<clearance::bvh<V, P>>> parts;
  for (const auto& primitives : s.parts)
    parts.push_back(clearance::make_part(clearance::build<V>(primitives, options, fit)));
  return clearance::model(std::move(parts));
}

/// Asks once with the shared bound and once with a bound per part.
template <class On, class Model, class S>
void check_query(const On& on, const Model& model, const std::vector<Eigen::Isometry3d>& poses,
                 const clearance::placed<S>& cloud, const brute_answer& expected, verdict& v, const std::string& what) {
  require_equal(clearance::ask(on, model, poses, cloud, clearance::min_distance{}), expected, v, what);
  const auto [r, minima] = clearance::ask(on, model, poses, cloud, clearance::min_distance_per_part{});
  require_equal(r, expected, v, what + ", per part");
  require_equal(minima, expected, v, what);
}

/// `each(use)` calls use(source, pose, name) for each wanted point source.
template <class V, class P, class Each, class Fit>
void check_trees(const scene<P>& s, Each each, Fit fit, const char* fit_name, verdict& v) {
  const auto parts = brute_parts(s);
  each([&](const auto& source, const Eigen::Isometry3d& pose, const char* source_name) {
    const clearance::placed cloud{source, pose};
    const brute_answer expected = brute_force(parts, s.poses, {brute_cloud(source, pose)});
    for (const std::uint32_t width : {2, 4, 8}) {
      const auto model = make_model<V>(s, {.width = width, .leaf_size = width == 4 ? 1u : 4u}, fit);
      const std::string what = s.name + ", width " + std::to_string(width) + ", " + fit_name + ", " + source_name;
      check_query(clearance::plain{clearance::host{}, clearance::recursive{}}, model, s.poses, cloud, expected, v,
                  what + ", recursive");
      check_query(clearance::plain{clearance::host{}, clearance::stack{}}, model, s.poses, cloud, expected, v,
                  what + ", stack");
      check_query(clearance::host{}, model, s.poses, cloud, expected, v, what + ", near first");
    }
  });
}

template <class V, class P>
void check_product() {
  verdict v;
  for (const auto& s : scenes<P>()) {
    const sources<P> all(s);
    const auto each = [&](auto use) {
      use(all.span, s.cloud_pose, "span");
      use(all.floats, s.cloud_pose, "floats");
      use(all.doubles, s.cloud_pose, "doubles");
      use(all.raw, all.camera_pose, "16-bit image");
      use(all.metres, all.camera_pose, "float image");
    };
    check_trees<V>(s, each, clearance::wrapped{}, "wrapped", v);
    if constexpr (requires(const V x) { clearance::bounding_volume_traits<V>::balls(x); })
      check_trees<V>(s, each, clearance::layered{}, "layered", v);
  }
}

}  // namespace testing
