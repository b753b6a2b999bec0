// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A point cloud in memory that keeps its file's numbering and precision.

#include <clearance/frames/clouds.hpp>
#include <clearance/io/same_eigen.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/strided_points.hpp>

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace clearance::io {

/// The sensor's pose in the cloud's frame as a file states it: not applied, not normalised, not checked.
struct viewpoint {
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
};

/// A cloud as a query reads it: floats relative to an origin. In the world point i is `pose * points[i]`, within `off`.
struct float_cloud {
  std::vector<vec3> points;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< In the cloud's frame.
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  position_error off;

  /// What min_distance takes; this object must outlive it.
  placed<point_span> view() const CLEARANCE_LIFETIMEBOUND {
    point_span source(points);
    source.filter.sensor = {-real(origin.x()), -real(origin.y()), -real(origin.z())};
    source.off = off;
    return {source, pose};
  }
};

/// Points in the file's order, one per record, with the file's coordinates (metres). An invalid record stays in its
/// place as NaN. A query needs floats: `ask(on, robot, poses, cloud.near(poses, world_from_cloud).view(), q)`.
struct cloud {
  std::string name;
  std::vector<Eigen::Vector3d> points;
  std::optional<io::viewpoint> viewpoint;
  std::size_t width = 0;  // an organised cloud has `height` rows of `width` points; any other has height 1
  std::size_t height = 1;

  /// Floats relative to `origin`, a position in the cloud's frame. They are exact where possible, else off by 2^-24 of
  /// their length; the bracket covers that. So it is tight for a robot near the origin, and true for any. Throws if the
  /// pose is not rigid.
  float_cloud relative_to(const Eigen::Vector3d& origin,
                          const Eigen::Isometry3d& world_from_cloud = Eigen::Isometry3d::Identity()) const;

  /// Floats for a robot whose parts have these poses (world-from-part), in one configuration or many. They are relative
  /// to 0 if the first part is within 32 m of it, so a file's floats stay as they are; else to that part's place,
  /// rounded to metres. So each of many configurations of a robot whose first part stays has the answer that it has
  /// alone.
  float_cloud near(std::span<const Eigen::Isometry3d> poses,
                   const Eigen::Isometry3d& world_from_cloud = Eigen::Isometry3d::Identity()) const;
};

/// A cloud of the given coordinates (metres).
cloud make_cloud(std::string name, std::vector<Eigen::Vector3d> points, std::size_t width, std::size_t height);

}  // namespace clearance::io
