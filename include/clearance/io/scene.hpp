// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A picture of a query for any glTF viewer: robot, points, witness.

#include <clearance/io/glb_writer.hpp>
#include <clearance/io/scene_balls.hpp>
#include <clearance/io/scene_mesh.hpp>
#include <clearance/io/write_file.hpp>

#include <Eigen/Geometry>

#include <string>
#include <vector>

namespace clearance::io {

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
inline std::string scene_bytes(const scene& world, const std::string& file) {
  glb_writer out(file);
  const auto add = [&](const std::string& name, const drawn_mesh& mesh, Eigen::Isometry3d pose, colour paint,
                       const std::string& group = {}) {
    pose.translation() -= world.origin;
    if (!mesh.positions.empty())
      out.add(scene_name(name), mesh, pose, paint, group.empty() ? group : scene_name(group));
  };
  for (const auto& body : world.bodies) add(body.name, faces_of(body.mesh), body.pose, body.paint, body.group);
  for (const auto& cloud : world.clouds)
    add(cloud.name, points_of(cloud.points, cloud.colours), cloud.pose, cloud.paint);
  for (const auto& set : world.balls) add(set.name, faces_of(set.balls), set.pose, set.paint, set.group);
  for (const auto& s : world.segments) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = s.from;
    add(s.name, faces_of(rod(s.to - s.from)), pose, s.paint);
  }
  return out.bytes();
}

/// Writes a scene as a binary glTF file (.glb), completely or not at all. Names become printable UTF-8. Throws
/// std::runtime_error.
inline void save_scene(const scene& world, const std::string& file) { write_bytes(file, scene_bytes(world, file)); }

}  // namespace clearance::io
