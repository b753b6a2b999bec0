// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/close_shape.hpp>
#include <clearance/solid/second_opinion.hpp>

namespace clearance {

namespace detail {

/// Closes a part's shapes one by one, joins them again, and judges how well the inside is then known.
class mesh_closer {
 public:
  mesh_closer(const triangle_mesh& mesh, const close_options& options) : mesh_(mesh), options_(options) {}

  closed_mesh close() && {
    std::vector<std::uint32_t> first = mesh_.shapes;
    if (first.empty()) first.push_back(0);
    first.push_back(std::uint32_t(mesh_.triangles.size()));
    std::vector<shape_surface> shapes;
    for (std::size_t k = 0; k + 1 < first.size(); ++k)
      if (first[k] < first[k + 1]) shapes.push_back(close_shape(first[k], first[k + 1]));
    out_.loaded = std::uint32_t(mesh_.triangles.size());
    out_.closed =
        options_.cap || std::all_of(shapes.begin(), shapes.end(), [](const auto& s) { return s.rims.empty(); });
    for (bool caps : {false, true}) {
      std::uint32_t vertex = 0, body = 0;
      for (std::uint32_t k = 0; k < shapes.size(); ++k) {
        append(shapes[k], k, caps, vertex, body);
        vertex += std::uint32_t(shapes[k].mesh.vertices.size()),
            body += std::uint32_t(shapes[k].bodies.one_sided.size());
      }
    }
    for (const shape_surface& s : shapes)
      out_.surface.vertices.insert(out_.surface.vertices.end(), s.mesh.vertices.begin(), s.mesh.vertices.end());
    const std::size_t kept = out_.surface.vertices.size() - cap_vertices_;  // several shapes may use a vertex
    out_.welded = std::uint32_t(mesh_.vertices.size() - std::min(kept, mesh_.vertices.size()));
    measure();
    if (!(out_.area > 0))
      throw std::invalid_argument(
          "clearance: the mesh is degenerate: none of its triangles keeps an area once near vertices are one");
    if (out_.closed) judge(std::uint32_t(shapes.size()));
    return std::move(out_);
  }

 private:
  shape_surface close_shape(std::uint32_t first, std::uint32_t last) {
    shape_surface s = weld_cracks(open_surface(weld(part_of(first, last)), options_), options_);
    loaded_.push_back(s.mesh.triangles.size());
    for (std::size_t i = 0; i < s.mesh.triangles.size(); ++i) {
      const auto& t = s.mesh.triangles[i];
      out_.duplicate += !s.counts[i] && t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    }
    out_.flipped += s.bodies.flipped, out_.one_sided_area += s.bodies.one_sided_area;
    out_.tolerance = std::max(out_.tolerance, s.moved);
    const std::size_t vertices = s.mesh.vertices.size();
    if (options_.cap) out_.caps.loops += add_caps(s);
    cap_vertices_ += std::uint32_t(s.mesh.vertices.size() - vertices);
    turn_out(s);
    return s;
  }

  /// These triangles, with the range of vertices that contains theirs.
  triangle_mesh part_of(std::uint32_t first, std::uint32_t last) const {
    std::uint32_t low = ~0u, high = 0;
    for (std::uint32_t i = first; i < last; ++i)
      for (const std::uint32_t v : mesh_.triangles[i]) low = std::min(low, v), high = std::max(high, v);
    triangle_mesh part;
    part.vertices.assign(mesh_.vertices.begin() + low, mesh_.vertices.begin() + high + 1);
    part.triangles.assign(mesh_.triangles.begin() + first, mesh_.triangles.begin() + last);
    for (auto& t : part.triangles)
      for (std::uint32_t& v : t) v -= low;
    return part;
  }

  /// Makes bodies face outwards for the winding number, however they were loaded. A body so flat that rounding decides
  /// encloses nothing.
  void turn_out(shape_surface& s) {
    const std::vector<double> volumes = body_volumes(s);
    std::vector<double> areas(volumes.size(), 0);
    std::vector<Eigen::AlignedBox3d> boxes(volumes.size());
    Eigen::AlignedBox3d all;
    for (std::size_t i = 0; i < s.mesh.triangles.size(); ++i) {
      const auto& t = s.mesh.triangles[i];
      if (!s.counts[i]) continue;
      const std::uint32_t b = s.bodies.body[i];
      areas[b] += area(s.mesh, t);
      for (const std::uint32_t v : t) boxes[b].extend(s.mesh.vertices[v]), all.extend(s.mesh.vertices[v]);
      if (volumes[b] < 0) s.counts[i] = -1;
    }
    for (std::size_t b = 0; b < volumes.size(); ++b) {
      const double size = boxes[b].isEmpty() ? 0 : boxes[b].diagonal().norm();
      out_.encloses.push_back(std::abs(volumes[b]) > 1e-9 * size * areas[b]);
      const bool nothing = areas[b] <= 1e-12 * all.diagonal().squaredNorm();  // slivers at joints
      unclean_.push_back(s.bodies.one_sided[b] || (!out_.encloses.back() && !nothing));
      capped_.push_back(false);
    }
    const std::size_t before = out_.encloses.size() - volumes.size();
    for (const body_rim& rim : s.rims) capped_[before + rim.body] = out_.encloses[before + rim.body];
  }

  static double area(const triangle_mesh& m, const std::array<std::uint32_t, 3>& t) {
    return (m.vertices[t[1]] - m.vertices[t[0]]).cross(m.vertices[t[2]] - m.vertices[t[0]]).norm() / 2;
  }

  /// Appends the shape's triangles as loaded, or those of its caps.
  void append(const shape_surface& s, std::uint32_t number, bool caps, std::uint32_t vertex, std::uint32_t body) {
    const std::size_t loaded = loaded_[number];
    for (std::size_t i = caps ? loaded : 0; i < (caps ? s.mesh.triangles.size() : loaded); ++i) {
      auto t = s.mesh.triangles[i];
      for (std::uint32_t& v : t) v += vertex;
      out_.surface.triangles.push_back(t);
      out_.counts.push_back(s.counts[i]);
      out_.body.push_back(body + s.bodies.body[i]);
      shape_.push_back(number);
    }
  }

  void measure() {
    for (std::size_t i = 0; i < out_.surface.triangles.size(); ++i) {
      const double a = area(out_.surface, out_.surface.triangles[i]);
      (i < out_.loaded ? out_.area : out_.caps.area) += a;
      out_.degenerate += i < out_.loaded && !(a > 0);
    }
  }

  /// Trusts winding numbers where bodies are clean. Elsewhere a flood adds what else is inside, to within the size of
  /// its cubes.
  void judge(std::uint32_t shapes) {
    std::vector<bool> unclean(shapes, false), capped(shapes, false);
    const second_opinion flooded(out_, shape_, shapes);
    forgive_one_flat_sheet(shapes);
    if (std::any_of(out_.encloses.begin(), out_.encloses.end(), [](bool e) { return e; })) {
      std::vector<std::uint32_t> body;
      const auto w = make_winding<double>(out_, &body);
      const std::vector<bool> cancels = cancelling_bodies(out_, w, body);
      for (std::size_t b = 0; b < cancels.size(); ++b) unclean_[b] = unclean_[b] || cancels[b];
      mark(unclean_, unclean), mark(capped_, capped);
      for (std::uint32_t k = 0; k < shapes; ++k)
        if (capped[k] && !unclean[k] && flooded.contradicts(k, w)) unclean[k] = true;
    } else {
      mark(unclean_, unclean);
    }
    const bool encloses = std::find(out_.encloses.begin(), out_.encloses.end(), true) != out_.encloses.end();
    out_.inside = !encloses                                                          ? inside_by::nothing
                  : std::find(capped_.begin(), capped_.end(), true) == capped_.end() ? inside_by::closed
                                                                                     : inside_by::caps;
    if (std::find(unclean.begin(), unclean.end(), true) == unclean.end()) return;
    out_.enclosed = flooded.enclosed(unclean);
    if (encloses || !out_.enclosed.bits.empty()) out_.inside = inside_by::flood;
    // The flood does not see anything thinner than two cubes, and the cubes at a region's walls do not count as
    // enclosed.
    out_.tolerance += 2 * std::sqrt(3.0) * out_.enclosed.cube;
  }

  void mark(const std::vector<bool>& bodies, std::vector<bool>& shapes) const {
    for (std::size_t i = 0; i < out_.body.size(); ++i)
      if (out_.counts[i] && bodies[out_.body[i]]) shapes[shape_[i]] = true;
  }

  /// A single flat sheet encloses nothing, whatever bodies are beside it. A shape with no other unclean body is clean.
  void forgive_one_flat_sheet(std::uint32_t shapes) {
    std::vector<std::vector<std::uint32_t>> sheets(shapes);
    std::vector<bool> seen(unclean_.size(), false);
    for (std::size_t i = 0; i < out_.body.size(); ++i)
      if (const std::uint32_t b = out_.body[i]; out_.counts[i] && unclean_[b] && !seen[b])
        seen[b] = true, sheets[shape_[i]].push_back(b);
    for (const auto& of_shape : sheets)
      if (of_shape.size() == 1 && flat(of_shape[0])) unclean_[of_shape[0]] = false;
  }
  bool flat(std::uint32_t body) const {
    const auto& v = out_.surface.vertices;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), origin = normal;
    double most = 0, height = 0, size = 0;
    const auto each = [&](auto visit) {
      for (std::size_t i = 0; i < out_.body.size(); ++i)
        if (out_.counts[i] && out_.body[i] == body) visit(out_.surface.triangles[i]);
    };
    each([&](const auto& t) {
      const Eigen::Vector3d n = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]);
      if (n.norm() > most) most = n.norm(), normal = n.normalized(), origin = v[t[0]];
    });
    each([&](const auto& t) {
      for (const std::uint32_t c : t)
        height = std::max(height, std::abs(normal.dot(v[c] - origin))), size = std::max(size, (v[c] - origin).norm());
    });
    return height <= 1e-9 * size;
  }

  const triangle_mesh& mesh_;
  const close_options& options_;
  closed_mesh out_;
  std::vector<std::size_t> loaded_;     // by shape: triangles that are not caps
  std::vector<std::uint32_t> shape_;    // by triangle
  std::vector<bool> unclean_, capped_;  // by body
  std::uint32_t cap_vertices_ = 0;
};

}  // namespace detail

/// Closes a mesh such as robots come with: open, badly oriented, not manifold, made of several shells. Each connected
/// body of each shape is closed separately; a point is inside if it is in any of them. Nothing is dropped; what was
/// found is counted. Throws std::invalid_argument if this is no mesh at all (see check_mesh).
inline closed_mesh close_mesh(const triangle_mesh& mesh, const close_options& options = {}) {
  check_mesh(mesh);
  return detail::mesh_closer(mesh, options).close();
}

}  // namespace clearance
