// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <numeric>
#include <span>

namespace clearance {

/// See append_cap.
inline void append_polygon(triangle_mesh& mesh, std::span<const std::uint32_t> loop) {
  const std::size_t n = loop.size();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(), middle = Eigen::Vector3d::Zero();
  const Eigen::Vector3d origin = mesh.vertices[loop[0]];
  for (std::size_t i = 0; i < n; ++i) {
    const Eigen::Vector3d a = mesh.vertices[loop[i]] - origin, b = mesh.vertices[loop[(i + 1) % n]] - origin;
    normal += a.cross(b);
    middle += a / double(n);
  }
  std::vector<std::uint32_t> left(n);  // positions in the loop that are still there
  std::iota(left.begin(), left.end(), 0u);
  constexpr std::size_t longest = 4096;  // cutting ears takes quadratic time
  if (normal.squaredNorm() > 0 && n <= longest) {
    normal.normalize();
    const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
    std::vector<Eigen::Vector2d> flat(n);
    for (std::size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d p = mesh.vertices[loop[i]] - origin;
      flat[i] = {p.dot(x), p.dot(y)};
    }
    const auto turn = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      const Eigen::Vector2d u = flat[b] - flat[a], v = flat[c] - flat[a];
      return u.x() * v.y() - u.y() * v.x();
    };
    std::size_t at = 0, failures = 0;
    while (left.size() > 3 && failures < left.size()) {
      const std::size_t m = left.size(), before = (at + m - 1) % m, after = (at + 1) % m;
      const std::uint32_t a = left[before], b = left[at], c = left[after];
      bool ear = turn(a, b, c) > 0;
      for (std::size_t i = 0; ear && i < m; ++i) {
        const std::uint32_t p = left[i];
        if (p == a || p == b || p == c) continue;
        ear = !(turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0);
      }
      if (ear) {
        mesh.triangles.push_back({loop[a], loop[b], loop[c]});
        left.erase(left.begin() + std::ptrdiff_t(at));
        failures = 0;
        at = at % left.size();
        at = (at + 1) % left.size();  // skipping one makes fatter ears than going round in order
      } else {
        at = after;
        ++failures;
      }
    }
  }
  if (left.size() == 3) {
    mesh.triangles.push_back({loop[left[0]], loop[left[1]], loop[left[2]]});
    return;
  }
  if (left.size() != n) {
    middle.setZero();
    for (const std::uint32_t i : left) middle += (mesh.vertices[loop[i]] - origin) / double(left.size());
  }
  const std::uint32_t hub = std::uint32_t(mesh.vertices.size());
  mesh.vertices.push_back(origin + middle);
  for (std::size_t i = 0; i < left.size(); ++i)
    mesh.triangles.push_back({hub, loop[left[i]], loop[left[(i + 1) % left.size()]]});
}

/// Triangles over a loop: after inner sides cancel, their sides are the loop's, in its direction. Ears are cut in the
/// loop's mean plane. Without an ear (the loop crosses itself, or is very long) the rest becomes a fan around the
/// middle, which may append one vertex. The reversed loop gets the same triangles, turned, so that two bodies that meet
/// in a loop leave nothing between their caps.
inline void append_cap(triangle_mesh& mesh, std::span<const std::uint32_t> given) {
  const std::size_t n = given.size(), start = std::size_t(std::min_element(given.begin(), given.end()) - given.begin());
  std::vector<std::uint32_t> loop(n);
  const bool turned = given[(start + 1) % n] > given[(start + n - 1) % n];
  for (std::size_t i = 0; i < n; ++i) loop[i] = given[(turned ? start + n - i : start + i) % n];
  const std::size_t before = mesh.triangles.size();
  append_polygon(mesh, loop);
  if (turned)
    for (std::size_t i = before; i < mesh.triangles.size(); ++i) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
}

}  // namespace clearance
