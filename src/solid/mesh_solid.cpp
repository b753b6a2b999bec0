// SPDX-License-Identifier: BSD-3-Clause
#include "solid/rays.hpp"

#include <clearance/solid/mesh_solid.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace clearance {

mesh_solid::mesh_solid(closed_mesh mesh) : mesh_solid(std::move(mesh), surface_too{}) {
  if (mesh_.one_sided_area > 0.5 * mesh_.area)
    throw std::invalid_argument("clearance: the mesh has no inside: its surface has only one side, as a Moebius strip");
  if (!(volume_ > 1e-9 * bounds_.diagonal().norm() * mesh_.area))
    throw std::invalid_argument("clearance: the mesh has no inside: it is a sheet, and its " +
                                std::to_string(mesh_.loaded) + " triangles and their caps enclose no volume");
}
mesh_solid::mesh_solid(const triangle_mesh& mesh) : mesh_solid(close_mesh(mesh)) {}

mesh_solid::mesh_solid(closed_mesh mesh, surface_too) : mesh_(std::move(mesh)) {
  winding_ = make_winding<double>(mesh_);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (const auto& t : mesh_.surface.triangles) {
    triangles_.emplace_back(mesh_.surface.vertices[t[0]], mesh_.surface.vertices[t[1]], mesh_.surface.vertices[t[2]]);
    boxes.push_back(triangles_.back().box());
    bounds_.extend(boxes.back());
  }
  const enclosed found = enclosed_volume(winding_);
  volume_ = found.volume;
  overlaps_ = found.overlaps;
  if (!mesh_.enclosed.bits.empty()) volume_ = std::max(volume_, mesh_.enclosed.volume());
  tree_ = box_tree(boxes);
}

std::vector<Eigen::Vector3d> mesh_solid::surface_points(std::size_t count) const {
  std::vector<double> until(triangles_.size());
  double sum = 0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) until[i] = sum += triangles_[i].area();
  std::vector<Eigen::Vector3d> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at =
        std::size_t(std::upper_bound(until.begin(), until.end(), sum * ((i + 0.5) / count)) - until.begin());
    const exact_triangle& t = triangles_[std::min(at, triangles_.size() - 1)];
    double u = std::fmod((i + 1) * 0.7548776662466927, 1.0), v = std::fmod((i + 1) * 0.5698402909980532, 1.0);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    points.push_back(t.corner(0) + u * (t.corner(1) - t.corner(0)) + v * (t.corner(2) - t.corner(0)));
  }
  return points;
}

bool has_inside(const closed_mesh& mesh) {
  return mesh.inside != inside_by::nothing && mesh.one_sided_area <= 0.5 * mesh.area;
}

}  // namespace clearance
