// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A picture of a query for any glTF viewer: robot, points, witness.

#include <clearance/ground/math.hpp>
#include <clearance/io/same_eigen.hpp>
#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace clearance::io {

/// 0 to 1 each.
struct colour {
  float red, green, blue, alpha;
};

/// The colour of a distance in metres: red at 0 and inside, then yellow, green (half way) and cyan, and blue from `far`
/// on.
colour distance_colour(double distance, double far);

struct scene_body {
  std::string name;
  triangle_mesh mesh;                                      // in the body's frame
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // world-from-body
  colour paint = {0.75f, 0.75f, 0.78f, 1};
  std::string group = {};  // the name of a node for all bodies and balls of a group; empty: none
};

struct scene_points {
  std::string name;
  std::vector<vec3> points;  // in the cloud's frame; those not finite are left out
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  colour paint = {0.25f, 0.45f, 0.85f, 1};
  std::vector<colour> colours = {};  // one per point, or empty: all have `paint`
};

struct scene_balls {
  std::string name;
  std::vector<ball> balls;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  colour paint = {0.9f, 0.7f, 0.3f, 1};
  std::string group = {};
};

/// A thin red rod in world coordinates.
struct scene_segment {
  std::string name;
  Eigen::Vector3d from, to;
  colour paint = {0.9f, 0.1f, 0.1f, 1};
};

/// Metres, z up, in world coordinates. `origin` is subtracted from them, because a glTF file holds floats.
struct scene {
  std::vector<scene_body> bodies;
  std::vector<scene_points> clouds;
  std::vector<scene_balls> balls;
  std::vector<scene_segment> segments;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
};

/// The scene as a binary glTF file. There y is up, so everything is turned by -90 degrees about x. Error sentences name
/// `file`.
std::string scene_bytes(const scene& world, const std::string& file);

/// Writes a scene as a binary glTF file (.glb), completely or not at all. Names become printable UTF-8. Throws
/// std::runtime_error.
void save_scene(const scene& world, const std::string& file);

}  // namespace clearance::io
