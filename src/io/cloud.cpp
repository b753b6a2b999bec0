// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/cloud.hpp>

#include <clearance/frames/clouds.hpp>
#include <clearance/frames/frame.hpp>
#include <clearance/points/strided_points.hpp>

#include <optional>
#include <string>
#include <utility>

namespace clearance::io {

float_cloud cloud::relative_to(const Eigen::Vector3d& origin, const Eigen::Isometry3d& world_from_cloud) const {
  float_cloud made{.points = {}, .origin = origin, .pose = rigid(world_from_cloud, "cloud"), .off = {}};
  if (!origin.isZero(0)) {  // the error of moving the frame; nobody can see it later
    made.off.absolute = frames::pose_error * (made.pose.translation().norm() + origin.norm());
    made.pose.translation() = made.pose * origin;
  }
  made.points.reserve(points.size());
  bool exact = true;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3d way = p - origin;
    made.points.push_back({to_float(way.x()), to_float(way.y()), to_float(way.z())});
    const vec3& f = made.points.back();
    exact = exact &&
            (!is_finite(f) || (f.x + origin.x() == p.x() && f.y + origin.y() == p.y() && f.z + origin.z() == p.z()));
  }
  if (!exact) made.off.relative = strided_points<double>{}.rounding().relative;
  return made;
}

float_cloud cloud::near(std::span<const Eigen::Isometry3d> poses, const Eigen::Isometry3d& world_from_cloud) const {
  if (poses.empty()) return relative_to(Eigen::Vector3d::Zero(), world_from_cloud);
  const world_transform first(poses[0]);
  const auto [x, y, z] =
      frames::middle_of(rigid_transform_of(world_from_cloud, "cloud"), [&first](std::uint32_t) { return first; }, 1);
  const Eigen::Vector3d middle(x, y, z);
  if (middle.cwiseAbs().maxCoeff() > 32) return relative_to(middle.array().round(), world_from_cloud);
  return relative_to(Eigen::Vector3d::Zero(), world_from_cloud);
}

cloud make_cloud(std::string name, std::vector<Eigen::Vector3d> points, std::size_t width, std::size_t height) {
  return {.name = std::move(name), .points = std::move(points), .viewpoint = {}, .width = width, .height = height};
}

}  // namespace clearance::io
