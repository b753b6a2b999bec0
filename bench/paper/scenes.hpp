// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The paper's two scenarios (its section 5), with a recorded motion of all seven joints in each: the robot in front of
// a table that a Kinect saw, clouds merged to a larger one; and an artificial room with far, evenly spread points.

#include "../min_distance/scene.hpp"

#include <clearance/io/cloud_file.hpp>

#include <array>
#include <functional>
#include <memory>
#include <random>

namespace bench::paper {

struct scenario {
  std::string name;
  Eigen::Isometry3d world_from_cloud = Eigen::Isometry3d::Identity();
  std::vector<std::size_t> sizes = {};
  std::size_t along_motion = 600'000;
  double cell = 0.05;  ///< The octree's, in metres: the best of those tried.
  std::function<std::vector<clearance::vec3>(std::size_t)> points = {};
  std::function<std::vector<Eigen::Isometry3d>(double)> poses =
      {};  ///< 0 <= t <= 1 along the motion; the paper's scene is at 0.
};

/// All recorded frames in turn. For fewer points, an even choice from the first; for more, repeats with 2 mm of noise.
inline std::vector<clearance::vec3> merged(const std::vector<clearance::vec3>& frames, std::size_t one_frame,
                                           std::size_t count) {
  std::vector<clearance::vec3> points;
  if (count < one_frame) {
    for (std::size_t i = 0; i < count; ++i) points.push_back(frames[i * one_frame / count]);
    return points;
  }
  std::mt19937 bits(7);
  std::normal_distribution<float> noise(0, 0.002f);
  points.assign(frames.begin(), frames.begin() + std::ptrdiff_t(std::min(count, frames.size())));
  while (points.size() < count) {
    const auto p = frames[points.size() % frames.size()];
    points.push_back({p.x + noise(bits), p.y + noise(bits), p.z + noise(bits)});
  }
  return points;
}

/// A room of 9 x 8 x 5.3 m around the robot, which stands on a column, with cupboards along the walls. An even sequence
/// covers one surface after another.
inline std::vector<clearance::vec3> room(std::size_t count) {
  struct patch {
    Eigen::Vector3d corner, a, b;
    double area() const { return a.cross(b).norm(); }
  };
  std::vector<patch> patches;
  const auto box = [&](Eigen::Vector3d low, Eigen::Vector3d size) {
    const Eigen::Vector3d x(size.x(), 0, 0), y(0, size.y(), 0), z(0, 0, size.z());
    for (const auto& [a, b, c] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
      patches.push_back({low, a, b});
      patches.push_back({low + c, a, b});
    }
  };
  box({-4.5, -4, -1.9}, {9, 8, 5.3});
  for (int i = 0; i < 4; ++i) {
    box({-4.3 + 2.2 * i, 3.2, -1.9}, {1.1, 0.7, 1.0 + 0.4 * i});
    box({-4.0 + 2.2 * i, -3.9, -1.9}, {1.3, 0.9, 2.2 - 0.4 * i});
  }
  double area = 0;
  for (const patch& p : patches) area += p.area();
  std::vector<clearance::vec3> points;
  points.reserve(count);
  double done = 0;
  for (const patch& p : patches) {
    done += p.area();
    const auto until = std::size_t(std::lround(double(count) * done / area));
    for (std::size_t i = 1; points.size() < until; ++i) {  // Roberts' two-dimensional low-discrepancy sequence
      const double u = std::fmod(0.5 + 0.7548776662466927 * double(i), 1.0),
                   v = std::fmod(0.5 + 0.5698402909980532 * double(i), 1.0);
      const Eigen::Vector3d at = p.corner + u * p.a + v * p.b;
      points.push_back({float(at.x()), float(at.y()), float(at.z())});
    }
  }
  return points;
}

/// The whole robot carried along, as on the paper's mobile platform.
inline std::vector<Eigen::Isometry3d> carried(const std::vector<Eigen::Isometry3d>& poses, Eigen::Vector3d by) {
  std::vector<Eigen::Isometry3d> moved;
  for (const auto& pose : poses) moved.push_back(Eigen::Translation3d(by) * pose);
  return moved;
}

/// The path in path.csv, made by make-path: seconds, and the angle of each joint.
inline constexpr std::array<double, 8> path[] = {
#include "path.inc"
};

/// Poses of the arm along the path, or nothing for another robot.
inline std::function<std::vector<Eigen::Isometry3d>(double)> along_path(const scene& robot) {
  if (robot.name != "kuka") return {};
  const auto arm = std::make_shared<const clearance::io::robot>(clearance::io::load_robot(
      std::filesystem::path(CLEARANCE_TEST_DATA) / "robots/kuka_lwr4plus_cad/kuka_lwr4plus.urdf",
      {.geometry = clearance::io::robot_geometry::visual}));
  return [arm](double t) {
    const auto& row = path[std::size_t(std::lround(t * double(std::size(path) - 1)))];
    return arm->poses(std::vector<double>(row.begin() + 1, row.end()));
  };
}

inline std::vector<scenario> scenarios(const scene& robot) {
  std::vector<clearance::vec3> frames = robot.cloud;
  const std::filesystem::path folder = std::filesystem::path(CLEARANCE_TEST_DATA) / "clouds/kinect_seq";
  if (robot.name == "kuka")
    for (const char* frame : {"frame_20121214T142256.068683.pcd", "frame_20121214T142256.332395.pcd"}) {
      const auto next = clearance::io::load_cloud((folder / frame).string()).relative_to({0, 0, 0}).points;
      frames.insert(frames.end(), next.begin(), next.end());
    }
  scenario table{.name = "table",
                 .world_from_cloud = robot.world_from_camera,
                 .sizes = {102'400, 307'200, 614'400, 1'000'000},
                 .cell = 0.03};
  table.points = [frames, one = robot.cloud.size()](std::size_t n) { return merged(frames, one, n); };
  table.poses = along_path(robot);
  if (!table.poses)  // a robot without a path: up and away from the table, and down again
    table.poses = [start = robot.poses](double t) {
      const double away = 0.5 - 0.5 * std::cos(2 * 3.14159265358979 * t);
      return carried(start, {-1.2 * away, 0.2 * away, 0.5 * away});
    };
  scenario hall{.name = "room", .sizes = {307'200, 1'000'000, 2'500'000, 5'000'000}, .cell = 0.1};
  hall.points = room;
  // Its platform drives towards the wall while the arm moves.
  hall.poses = [start = robot.poses, arm = along_path(robot)](double t) {
    return carried(arm ? arm(t) : start, {1.6 + 1.8 * t, 0.6 * t, 0});
  };
  return {table, hall};
}

}  // namespace bench::paper
