// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot as an obstacle: the inner spheres of its parts as full balls, in the memory where they are.

#include <clearance/frames/clouds.hpp>
#include <clearance/points/solid_balls.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/robot/model.hpp>

namespace clearance {

namespace detail {

/// A tree of `build`, on any backend, over inner spheres.
template <class T>
inline constexpr bool holds_spheres = false;
template <class V, class B>
inline constexpr bool holds_spheres<bvh<V, inner_sphere, B>> = true;
template <class T>
inline constexpr bool on_the_host = false;
template <class V, class P>
inline constexpr bool on_the_host<bvh<V, P, host>> = true;

template <class Part>
consteval bool explain_spheres() {
  constexpr bool spheres = requires(const Part p) { requires holds_spheres<std::remove_cvref_t<decltype(p.tree)>>; };
  static_assert(spheres, "balls are inner spheres: pack the parts of this robot, which are of something else");
  return spheres;
}

}  // namespace detail

/// The spheres of a part as full balls in its frame, with its gap and tolerance. Ball i is that of `ids[i]` in its
/// tree. A view: the part must outlive it. Of a part on a device they stay there.
template <rigid_part Part>
auto as_balls(const Part& part CLEARANCE_LIFETIMEBOUND) {
  if constexpr (detail::explain_spheres<Part>())
    return detail::balls_at<detail::on_the_host<std::remove_cvref_t<decltype(part.tree)>>>(
        part.tree.primitives.data(), part.tree.primitives.size(), part.facts.gap, part.facts.tolerance);
}
template <owning_robot Part>
void as_balls(const Part&&) = delete;  // it would be gone before its spheres are read; name it

/// Another robot, placed by its own poses, world-from-part: one cloud for each part, in order, so that `cloud` of an
/// answer names the part. Throws std::invalid_argument unless there is one pose for each part.
template <class Part, class B>
auto as_balls(const model<Part, B>& robot CLEARANCE_LIFETIMEBOUND, std::span<const Eigen::Isometry3d> poses) {
  if constexpr (detail::explain_spheres<Part>()) {
    if (poses.size() != robot.size())
      throw std::invalid_argument("clearance: there are " + std::to_string(robot.size()) + " parts, but " +
                                  std::to_string(poses.size()) + " poses");
    std::vector<placed<decltype(as_balls(robot.parts()[0]))>> all;
    for (std::size_t k = 0; k < poses.size(); ++k) all.emplace_back(as_balls(robot.parts()[k]), poses[k]);
    return all;
  }
}
template <class Part, class B>
void as_balls(const model<Part, B>&&, std::span<const Eigen::Isometry3d>) = delete;  // the same, of a robot

}  // namespace clearance
