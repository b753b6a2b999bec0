// SPDX-License-Identifier: BSD-3-Clause
// A type that cannot be changed as a bounding volume: Eigen's own box, taught to the library from outside.
#include <clearance/backends/host.hpp>
#include <clearance/bvh/build.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/aabb.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>

// [traits]
template <>
struct clearance::bounding_volume_traits<Eigen::AlignedBox3f> {
  /// Eigen writes its copy constructors out, so the compiler cannot know that copying the bytes is enough.
  static constexpr bool bitwise_copyable = true;

  static Eigen::AlignedBox3f fit(std::span<const ball> balls) {
    Eigen::AlignedBox3d exact;
    for (const ball& b : balls) {
      const Eigen::Vector3d center(b.center.x, b.center.y, b.center.z), radius = Eigen::Vector3d::Constant(b.radius);
      exact.extend(center - radius).extend(center + radius);
    }
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(2.0 * slack * exact.diagonal().norm());
    Eigen::AlignedBox3f box;
    for (int k = 0; k < 3; ++k) {
      box.min()[k] = rounded_down(exact.min()[k] - margin[k]);
      box.max()[k] = rounded_up(exact.max()[k] + margin[k]);
    }
    return box;
  }

  /// Negative inside: Eigen's own exteriorDistance stops at 0, and the deepest point would be lost.
  CLEARANCE_HD static real lower_bound(const Eigen::AlignedBox3f& box, vec3 q) {
    const Eigen::Array3f p(q.x, q.y, q.z);
    const Eigen::Array3f beyond = (box.min().array() - p).max(p - box.max().array());
    const real deepest = beyond.maxCoeff();
    return deepest < 0 ? deepest * (1 + slack) : beyond.max(0.0f).matrix().norm() * (1 - slack);
  }
};

static_assert(clearance::explain_bounding_volume<Eigen::AlignedBox3f>());
// [traits]

int main() {
  std::vector<clearance::inner_sphere> spheres;
  for (int k = 0; k < 500; ++k) spheres.push_back({{0.01f * (k % 7), 0.01f * (k % 11), 0.01f * (k % 13)}, 0.004f});
  std::vector<clearance::vec3> cloud;
  for (int k = 0; k < 2000; ++k) cloud.push_back({0.2f - 0.0001f * k, 0.2f, 0.0001f * k});
  const clearance::host here;
  const Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();

  const auto eigens = clearance::make_part(clearance::build<Eigen::AlignedBox3f>(spheres));
  const auto ours = clearance::make_part(clearance::build<clearance::aabb>(spheres));
  const auto a = clearance::ask(here, eigens, pose, cloud, clearance::min_distance{});
  const auto b = clearance::ask(here, ours, pose, cloud, clearance::min_distance{});
  std::printf("%.6f m to point %u in Eigen's boxes, %.6f m to point %u in ours\n", a.distance, a.point, b.distance,
              b.point);
  return a.distance == b.distance && a.point == b.point && a.primitive == b.primitive ? 0 : 1;
}
