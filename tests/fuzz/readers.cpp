// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/io/ply_writer.hpp>
#include <clearance/io/spheres_file.hpp>

namespace fuzz {

using namespace clearance;

bool same(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  const auto equal = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
  return std::ranges::equal(a, b, [&](const auto& p, const auto& q) {
    return equal(p.x(), q.x()) && equal(p.y(), q.y()) && equal(p.z(), q.z());
  });
}

std::vector<Eigen::Vector3d> corners(const triangle_mesh& mesh) {
  std::vector<Eigen::Vector3d> made;
  for (const auto& t : mesh.triangles)
    for (const auto v : t) {
      if (v >= mesh.vertices.size()) finding("a triangle's corner that is no vertex");
      made.push_back(mesh.vertices[v]);
      if (!made.back().allFinite()) finding("a corner that is not finite");
    }
  return made;
}

void read_mesh(const std::string& file, std::string_view content) {
  put(file, content);
  triangle_mesh mesh;
  if (!reads(file, [&] { mesh = io::load_mesh(file, meshes); })) return;
  const auto all = corners(mesh);
  if (all.empty()) finding("a mesh without triangles");
  if (!same(all, corners(io::load_mesh(file, meshes)))) finding("the same file twice, two meshes");
}

void read_cloud(const std::string& file, std::string_view content) {
  put(file, content);
  io::cloud cloud;
  if (!reads(file, [&] { cloud = io::load_cloud(file, limits); })) return;
  if (cloud.width * cloud.height != cloud.points.size()) finding("width times height is not the number of points");
  if (!same(cloud.points, io::read_ply(io::ply_bytes(cloud.points, {}), "written").points))
    finding("written as PLY, it is another cloud");
}

static bool same_spheres(const std::vector<io::packed_part>& a, const std::vector<io::packed_part>& b) {
  return std::ranges::equal(a, b, [](const auto& p, const auto& q) {
    return p.name == q.name &&
           std::ranges::equal(p.spheres.spheres, q.spheres.spheres, [](const auto& s, const auto& t) {
             return s.center.x == t.center.x && s.center.y == t.center.y && s.center.z == t.center.z &&
                    s.radius == t.radius;
           });
  });
}

void read_spheres(const std::string& file, std::string_view content) {
  put(file, content);
  std::vector<io::packed_part> parts;
  if (!reads(file, [&] { parts = io::load_spheres(file); })) return;
  const std::string kept = io::ist_bytes(parts);
  const auto again = io::read_ist(kept, "written");
  if (!same_spheres(parts, again) || io::ist_bytes(again) != kept) finding("written as .ist, they are other spheres");
  if (!reads(file, [&] { io::save_spheres(parts, file); })) return;  // a name that YAML cannot hold
  if (!same_spheres(parts, io::load_spheres(file))) finding("written in their format, they are other spheres");
}

}  // namespace fuzz
