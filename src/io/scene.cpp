// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/scene.hpp>

#include "io/glb_writer.hpp"

#include <clearance/io/write_file.hpp>

namespace clearance::io {

colour distance_colour(double distance, double far) {
  const double along = std::clamp(4 * distance / far, 0.0, 4.0);
  const auto part = [](double value) { return float(std::clamp(value, 0.0, 1.0)); };
  return {part(2 - along), std::min(part(along), part(4 - along)), part(along - 2), 1};
}

std::string scene_bytes(const scene& world, const std::string& file) {
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

void save_scene(const scene& world, const std::string& file) { write_bytes(file, scene_bytes(world, file)); }

}  // namespace clearance::io
