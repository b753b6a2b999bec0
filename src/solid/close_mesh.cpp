// SPDX-License-Identifier: BSD-3-Clause
#include "solid/close_shape.hpp"
#include "solid/flood.hpp"
#include "solid/polygon.hpp"
#include "solid/rays.hpp"

#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/winding.hpp>

#include <stdexcept>
#include <string>

namespace clearance {

namespace {

/// A grid of at most about `cubes` cubes around a box, with a spare layer on every side. Rows along x fill whole words.
enclosure_grid grid_around(const Eigen::AlignedBox3d& box, double cubes) {
  enclosure_grid g;
  const Eigen::Vector3d extent = box.sizes();
  const auto count = [&](double cube) {
    double all = 1;
    for (int k = 0; k < 3; ++k) all *= std::ceil(extent[k] / cube) + 3;
    return all;
  };
  g.cube = extent.maxCoeff() / 1024;
  while (count(g.cube) > cubes) g.cube *= 1.02;
  g.low = box.min() - Eigen::Vector3d::Constant(1.5 * g.cube);
  for (int k = 0; k < 3; ++k) g.size[k] = std::uint32_t(std::ceil(extent[k] / g.cube)) + 3;
  g.size[0] = (g.size[0] + 31) / 32 * 32;
  return g;
}

/// Bodies with a winding number below 0 somewhere: they cross themselves, and another body's number could cancel
/// theirs. Rays find them if they are at least a hundredth of the part.
std::vector<bool> cancelling_bodies(const closed_mesh& mesh, const basic_winding<double>& w,
                                    std::span<const std::uint32_t> body) {
  std::vector<bool> cancels(mesh.encloses.size(), false);
  std::vector<std::int32_t> number(cancels.size(), 0);
  std::vector<std::uint32_t> below;  // bodies whose number fell below 0 since the last piece of some length
  for_each_ray(w, affordable_rays(w, 128), [&](std::span<const ray_hit> hits) {
    for (std::size_t k = 0; k < hits.size(); ++k) {
      const std::uint32_t its = body[hits[k].triangle];
      number[its] -= hits[k].sign;
      if (number[its] == -1 && hits[k].sign == 1) below.push_back(its);
      if (k + 1 == hits.size() || !(hits[k + 1].x - hits[k].x > least_piece(w))) continue;
      for (const std::uint32_t b : below)
        if (number[b] < 0) cancels[b] = true;
      below.clear();
    }
    for (const ray_hit& hit : hits) number[body[hit.triangle]] = 0;
    below.clear();
  });
  return cancels;
}

/// What a flood from outside does not reach in a mesh's shapes.
class second_opinion {
 public:
  /// `shape`: the shape of each triangle, caps included. `strays`: by shape, caps that are no surface.
  second_opinion(const closed_mesh& mesh, std::span<const std::uint32_t> shape, std::vector<polygon_triangles> strays)
      : mesh_(mesh), strays_of_(std::move(strays)), triangles_of_(strays_of_.size()) {
    for (std::uint32_t i = 0; i < shape.size(); ++i) triangles_of_[shape[i]].push_back(mesh.surface.triangles[i]);
  }

  /// Is there a cube that a flood around this shape does not reach, but that is outside by the winding numbers? Coarse,
  /// because it only checks what caps closed.
  bool contradicts(std::uint32_t shape, const basic_winding<double>& w) const {
    Eigen::AlignedBox3d box;
    extend(box, shape);
    const enclosure_grid grid = grid_around(box, coarse_cubes);
    const std::size_t row = grid.size[0], layer = row * grid.size[1];
    const std::vector<std::uint32_t> bits = flooded(grid, shape, false);
    for (std::size_t i = 0; i < layer * grid.size[2]; ++i)
      if (bits[i / 32] >> i % 32 & 1) {
        const Eigen::Vector3d cube(i % row, i / row % grid.size[1], i / layer);
        const Eigen::Vector3d p = grid.low + grid.cube * (cube + Eigen::Vector3d::Constant(0.5));
        if (!w.view().inside(p.x(), p.y(), p.z())) return true;
      }
    return false;
  }

  /// All cubes that floods around each of these shapes do not reach. `cube` is set even if nothing is enclosed.
  enclosure_grid enclosed(const std::vector<bool>& shapes) const {
    Eigen::AlignedBox3d box;
    for (std::uint32_t s = 0; s < shapes.size(); ++s)
      if (shapes[s]) extend(box, s);
    const auto floods = double(std::count(shapes.begin(), shapes.end(), true));
    enclosure_grid grid = grid_around(box, fine_cubes * std::min(1.0, most_fine / floods));
    std::vector<std::uint32_t> all;
    for (std::uint32_t s = 0; s < shapes.size(); ++s) {
      if (!shapes[s]) continue;
      add(flooded(grid, s, true), all);
    }
    if (std::any_of(all.begin(), all.end(), [](std::uint32_t word) { return word != 0; })) grid.bits = std::move(all);
    return grid;
  }

 private:
  // 50 and 200 cubes along each side of a cube. A fine flood takes a twentieth of a second; for many shapes they are
  // coarser.
  static constexpr double coarse_cubes = 1 << 17, fine_cubes = 1 << 23, most_fine = 16;

  std::array<Eigen::Vector3d, 3> corners(const std::array<std::uint32_t, 3>& t) const {
    return {mesh_.surface.vertices[t[0]], mesh_.surface.vertices[t[1]], mesh_.surface.vertices[t[2]]};
  }
  void extend(Eigen::AlignedBox3d& box, std::uint32_t shape) const {
    for (const auto& t : triangles_of_[shape])
      for (const auto& c : corners(t)) box.extend(c);
  }
  /// What is enclosed if stray caps are no walls, or if they are: they close holes, but may divide the inside.
  std::vector<std::uint32_t> flooded(const enclosure_grid& grid, std::uint32_t shape, bool passages) const {
    flood from_outside(grid, passages);
    for (const auto& t : triangles_of_[shape]) from_outside.add(corners(t));
    std::vector<std::uint32_t> bits = from_outside.enclosed();
    if (strays_of_[shape].empty()) return bits;
    for (const auto& t : strays_of_[shape]) from_outside.add(corners(t));
    add(from_outside.enclosed(), bits);
    return bits;
  }
  static void add(const std::vector<std::uint32_t>& some, std::vector<std::uint32_t>& bits) {
    bits.resize(some.size());
    for (std::size_t i = 0; i < some.size(); ++i) bits[i] |= some[i];
  }

  const closed_mesh& mesh_;
  std::vector<polygon_triangles> strays_of_, triangles_of_;
};

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
        vertex += std::uint32_t(shapes[k].mesh.vertices.size());
        body += std::uint32_t(shapes[k].bodies.one_sided.size());
      }
    }
    for (const shape_surface& s : shapes)
      out_.surface.vertices.insert(out_.surface.vertices.end(), s.mesh.vertices.begin(), s.mesh.vertices.end());
    const std::size_t kept = out_.surface.vertices.size();  // several shapes may use a vertex
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
    out_.flipped += s.bodies.flipped;
    out_.one_sided_area += s.bodies.one_sided_area;
    if (options_.cap) out_.caps.loops += add_caps(s, patience_);
    out_.tolerance = std::max(out_.tolerance, s.moved);
    turn_out(s);
    return s;
  }

  /// These triangles, with the range of vertices that contains theirs.
  triangle_mesh part_of(std::uint32_t first, std::uint32_t last) const {
    std::uint32_t low = ~0u, high = 0;
    for (std::uint32_t i = first; i < last; ++i)
      for (const std::uint32_t v : mesh_.triangles[i]) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
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
      for (const std::uint32_t v : t) {
        boxes[b].extend(s.mesh.vertices[v]);
        all.extend(s.mesh.vertices[v]);
      }
      if (volumes[b] < 0) s.counts[i] = -1;
    }
    for (std::size_t b = 0; b < volumes.size(); ++b) {
      const double size = boxes[b].isEmpty() ? 0 : boxes[b].diagonal().norm();
      const bool open = !s.open.empty() && s.open[b];
      out_.encloses.push_back(!open && std::abs(volumes[b]) > 1e-9 * size * areas[b]);
      const bool nothing = areas[b] <= 1e-12 * all.diagonal().squaredNorm();  // slivers at joints
      out_.sheets += !open && !out_.encloses.back() && !nothing;
      unclean_.push_back(s.bodies.one_sided[b] || (!out_.encloses.back() && !nothing));
      capped_.push_back(false);
      open_.push_back(open);
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
      out_.counts.push_back(s.open.empty() || !s.open[s.bodies.body[i]] ? s.counts[i] : 0);
      out_.body.push_back(body + s.bodies.body[i]);
      shape_.push_back(number);
      repeats_.push_back(s.counts[i] == 0);
    }
    if (!caps) return;
    walls_.push_back(s.strays);
    for (auto& t : walls_.back())
      for (std::uint32_t& v : t) v += vertex;
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
    const second_opinion flooded(out_, shape_, walls_);
    forgive_one_flat_sheet(shapes);
    if (std::any_of(out_.encloses.begin(), out_.encloses.end(), [](bool e) { return e; })) {
      std::vector<std::uint32_t> body;
      const auto w = make_winding<double>(out_, &body);
      const std::vector<bool> cancels = cancelling_bodies(out_, w, body);
      for (std::size_t b = 0; b < cancels.size(); ++b) unclean_[b] = unclean_[b] || cancels[b];
      mark(unclean_, unclean);
      mark(capped_, capped);
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
    out_.tolerance += flood::width * out_.enclosed.cube;
  }

  void mark(const std::vector<bool>& bodies, std::vector<bool>& shapes) const {
    for (std::size_t i = 0; i < out_.body.size(); ++i)
      if (!repeats_[i] && bodies[out_.body[i]]) shapes[shape_[i]] = true;
  }

  /// A single flat sheet encloses nothing, whatever bodies are beside it. A shape with no other unclean body is clean.
  void forgive_one_flat_sheet(std::uint32_t shapes) {
    constexpr std::uint32_t none = ~0u, several = ~1u;
    std::vector<std::uint32_t> sheet(shapes, none);  // the only unclean body of a shape
    std::vector<polygon_triangles> triangles(shapes);
    for (std::size_t i = 0; i < out_.body.size(); ++i) {
      const std::uint32_t b = out_.body[i], k = shape_[i];
      if (repeats_[i] || !unclean_[b] || sheet[k] == several) continue;
      sheet[k] = sheet[k] == none || sheet[k] == b ? b : several;
      triangles[k].push_back(out_.surface.triangles[i]);
    }
    for (std::uint32_t k = 0; k < shapes; ++k)
      if (const std::uint32_t b = sheet[k]; b != none && b != several && !open_[b] && flat(triangles[k]))
        unclean_[b] = false;
  }
  bool flat(const polygon_triangles& triangles) const {
    const auto& v = out_.surface.vertices;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero(), origin = normal;
    double most = 0, height = 0, size = 0;
    for (const auto& t : triangles) {
      const Eigen::Vector3d n = (v[t[1]] - v[t[0]]).cross(v[t[2]] - v[t[0]]);
      if (n.norm() > most) {
        most = n.norm();
        normal = n.normalized();
        origin = v[t[0]];
      }
    }
    for (const auto& t : triangles)
      for (const std::uint32_t c : t) {
        height = std::max(height, std::abs(normal.dot(v[c] - origin)));
        size = std::max(size, (v[c] - origin).norm());
      }
    return height <= 1e-9 * size;
  }

  const triangle_mesh& mesh_;
  const close_options& options_;
  closed_mesh out_;
  std::vector<std::size_t> loaded_;       // by shape: triangles that are not caps
  std::vector<std::uint32_t> shape_;      // by triangle
  std::vector<bool> repeats_;             // by triangle: it lies on others, or has a corner twice
  std::vector<bool> unclean_, capped_;    // by body
  std::vector<bool> open_;                // by body: it has a cap that is none
  std::vector<polygon_triangles> walls_;  // by shape: such caps
  std::size_t patience_ = 1'000'000'000;  // looks at corners that caps may take: a few seconds
};

}  // namespace

const char* to_string(inside_by by) {
  switch (by) {
    case inside_by::nothing:
      return "nothing";
    case inside_by::closed:
      return "closed";
    case inside_by::caps:
      return "caps";
    case inside_by::flood:
      return "flood";
  }
  return "";
}

void check(const closed_mesh& mesh) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("clearance: the closed mesh " + why); };
  const std::size_t size = mesh.surface.triangles.size();
  check_corners(mesh.surface);
  if (mesh.loaded > size)
    refuse("has " + std::to_string(size) + " triangles, of which " + std::to_string(mesh.loaded) + " were loaded");
  if (mesh.closed && (mesh.counts.size() != size || mesh.body.size() != size))
    refuse("has " + std::to_string(size) + " triangles, but says of " + std::to_string(mesh.counts.size()) +
           " how they count, and of " + std::to_string(mesh.body.size()) + " to which body they belong");
  if (!(mesh.tolerance >= 0))
    refuse("has a tolerance of " + std::to_string(mesh.tolerance) + " m, which must be 0 or more");
  const enclosure_grid& cubes = mesh.enclosed;
  if (cubes.bits.empty()) return;
  const std::size_t words = std::size_t(cubes.size[0] / 32) * cubes.size[1] * cubes.size[2];
  if (!(cubes.cube > 0) || !cubes.low.allFinite() || cubes.size[0] % 32 != 0 || words != cubes.bits.size())
    refuse("has " + std::to_string(cubes.bits.size()) + " words of enclosed cubes, which are not those of its grid");
}

closed_mesh close_mesh(const triangle_mesh& mesh, const close_options& options) {
  check_mesh(mesh);
  return mesh_closer(mesh, options).close();
}

}  // namespace clearance
