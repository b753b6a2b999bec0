// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Solids as found in files: a clean one, and versions with damage. The clean one tells what is inside.

#include "solid/shapes.hpp"
#include "support/random.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <vector>

namespace testing {

using Eigen::Vector3d;

/// Closed and clean bodies, of which a point may be in any.
struct bodies_of_truth {
  std::vector<clearance::triangle_mesh> bodies;

  /// Metres to the surface of the union, as far as a body's own surface says: negative in a body. An inner body's
  /// surface counts too, so that it is at most the depth. By brute force and solid angles, which share nothing with the
  /// library.
  double signed_distance(const Vector3d& at) const {
    double least = std::numeric_limits<double>::infinity(), deepest = -1;  // none
    for (const auto& body : bodies) {
      double angle = 0, nearest = std::numeric_limits<double>::infinity();
      for (const auto& t : body.triangles) {
        const Vector3d &a = body.vertices[t[0]], &b = body.vertices[t[1]], &c = body.vertices[t[2]];
        nearest = std::min(nearest, to_triangle(at, a, b, c));
        const Vector3d r[3] = {a - at, b - at, c - at};
        const double l[3] = {r[0].norm(), r[1].norm(), r[2].norm()};
        angle += std::atan2(r[0].dot(r[1].cross(r[2])),
                            l[0] * l[1] * l[2] + r[0].dot(r[1]) * l[2] + r[1].dot(r[2]) * l[0] + r[2].dot(r[0]) * l[1]);
      }
      if (std::abs(angle) > 3)  // half the winding number's 2 pi
        deepest = std::max(deepest, nearest);
      else
        least = std::min(least, nearest);
    }
    return deepest >= 0 ? -deepest : least;
  }
  /// Metres to the nearest body's surface.
  double to_surface(const Vector3d& at) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& body : bodies)
      for (const auto& t : body.triangles)
        nearest = std::min(nearest, to_triangle(at, body.vertices[t[0]], body.vertices[t[1]], body.vertices[t[2]]));
    return nearest;
  }

 private:
  static double to_triangle(const Vector3d& p, const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    const auto segment = [&](const Vector3d& u, const Vector3d& v) {
      const Vector3d e = v - u;
      return (p - u - (e.squaredNorm() > 0 ? std::clamp((p - u).dot(e) / e.squaredNorm(), 0.0, 1.0) : 0.0) * e).norm();
    };
    double best = std::min({segment(a, b), segment(b, c), segment(c, a)});
    const Vector3d n = (b - a).cross(c - a);
    if (!(n.norm() > 0)) return best;
    const Vector3d q = p - n * (n.dot(p - a) / n.squaredNorm());
    if (n.dot((b - a).cross(q - a)) >= 0 && n.dot((c - b).cross(q - b)) >= 0 && n.dot((a - c).cross(q - c)) >= 0)
      best = std::min(best, std::abs(n.dot(p - a)) / n.norm());
    return best;
  }
};

/// A mesh, what it was made of, and how far from its surface nothing is promised.
struct damaged_solid {
  clearance::triangle_mesh mesh;
  bodies_of_truth truth;
  double damage = 0;  // metres
  std::string history;

  double size() const {
    Eigen::AlignedBox3d box;
    for (const auto& v : mesh.vertices) box.extend(v);
    return box.diagonal().norm();
  }
};

/// What may be wrong with a mesh. Each makes of one solid another of the same truth.
struct damages {
  dice& d;

  /// Whole bodies face inwards; here, what hangs together by its vertices.
  void flipped(damaged_solid& s) const {
    const std::vector<std::uint32_t> of = components(s.mesh);
    const unsigned which = unsigned(d.below(2));
    for (std::size_t i = 0; i < of.size(); ++i)
      if ((of[i] + which) % 2 == 0 || which == 1) std::swap(s.mesh.triangles[i][1], s.mesh.triangles[i][2]);
  }
  /// Some triangles face the other way.
  void some_flipped(damaged_solid& s) const {
    for (auto& t : s.mesh.triangles)
      if (d.below(6) == 0) std::swap(t[1], t[2]);
  }
  void doubled(damaged_solid& s) const {
    const std::size_t n = s.mesh.triangles.size();
    const bool all = d.below(2) == 0;
    for (std::size_t i = 0; i < n; ++i)
      if (all || d.below(3) == 0) {
        auto t = s.mesh.triangles[i];
        if (d.below(2) == 0) std::swap(t[0], t[2]);
        s.mesh.triangles.push_back(t);
      }
  }
  /// Quads are stored for the other side too, and split along their other diagonals.
  void other_diagonal(damaged_solid& s) const {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::pair<std::size_t, std::uint32_t>>
        open;  // a side: triangle and corner opposite
    std::vector<bool> used(s.mesh.triangles.size(), false);
    const std::size_t n = s.mesh.triangles.size();
    for (std::size_t i = 0; i < n; ++i)
      for (int k = 0; k < 3 && !used[i]; ++k) {
        const auto t = s.mesh.triangles[i];
        const std::uint32_t a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        const auto at = open.find({std::min(a, b), std::max(a, b)});
        if (at == open.end() || used[at->second.first]) {
          open[{std::min(a, b), std::max(a, b)}] = {i, c};
          continue;
        }
        const std::uint32_t e = at->second.second;
        const auto& v = s.mesh.vertices;
        const Vector3d normal = (v[b] - v[a]).cross(v[c] - v[a]);
        if (!(normal.norm() > 0) || e == c || !convex(v[a], v[e], v[b], v[c])) continue;
        const double warp = std::abs(normal.normalized().dot(v[e] - v[a]));
        if (warp > 1e-3 * s.size()) continue;  // an edge of the solid, not the diagonal of a face
        s.damage = std::max(s.damage, warp);
        used[i] = used[at->second.first] = true;
        s.mesh.triangles.push_back({c, b, e});
        s.mesh.triangles.push_back({c, e, a});
      }
  }
  /// Faces that should meet miss one another.
  void cracks(damaged_solid& s) const {
    const double reach = s.size() * std::pow(10, d.number(-12, -4)) / 2;
    s.mesh = shapes::soup(s.mesh);
    for (auto& v : s.mesh.vertices) {
      const clearance::vec3 way = d.direction();
      v += d.number(0, reach) * Vector3d(way.x, way.y, way.z);
    }
    s.damage += 2 * reach;
  }
  void removed(damaged_solid& s) const {
    const std::size_t count = std::min<std::size_t>(1 + d.below(20), s.mesh.triangles.size() / 4);
    const bool together = d.below(2) == 0;
    clearance::triangle_mesh gone{s.mesh.vertices, {}};
    for (std::size_t k = 0; k < count; ++k) {
      std::size_t i = d.below(unsigned(s.mesh.triangles.size()));
      if (together && k > 0) {  // beside those that are gone
        for (std::size_t tries = 0; tries < 200; ++tries, i = d.below(unsigned(s.mesh.triangles.size())))
          if (touches(gone, s.mesh.triangles[i])) break;
      }
      gone.triangles.push_back(s.mesh.triangles[i]);
      s.mesh.triangles.erase(s.mesh.triangles.begin() + std::ptrdiff_t(i));
    }
    s.damage += largest_component(gone);
  }
  /// A wall between two triangles of the solid's edge: a sheet inside it.
  void inner_wall(damaged_solid& s) const {
    const auto edges = unsigned(s.mesh.triangles.size());
    const auto& t = s.mesh.triangles[d.below(edges)];
    const auto& u = s.mesh.triangles[d.below(edges)];
    const Vector3d middle = (s.mesh.vertices[t[0]] + s.mesh.vertices[u[1]]) / 2;
    if (s.truth.signed_distance(middle) >= 0) return;
    // Where the solid is not convex, or is two bodies, a wall may leave it; then that is a surface, and no inner wall.
    constexpr int steps = 24;
    const Vector3d a = s.mesh.vertices[t[0]] - middle, b = s.mesh.vertices[t[1]] - middle;
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j)
        if (s.truth.signed_distance(middle + (i * a + j * b) / steps) > s.damage + 1e-9 * s.size()) return;
    const auto n = std::uint32_t(s.mesh.vertices.size());
    s.mesh.vertices.push_back(middle);
    s.mesh.triangles.push_back({t[0], t[1], n});
  }
  /// A corner of one side in the middle of the other's.
  void t_joints(damaged_solid& s) const {
    for (int k = 0; k < 4; ++k) {
      const std::size_t i = d.below(unsigned(s.mesh.triangles.size()));
      const auto t = s.mesh.triangles[i];
      const auto n = std::uint32_t(s.mesh.vertices.size());
      s.mesh.vertices.push_back(s.mesh.vertices[t[0]] +
                                d.number(0.1f, 0.9f) * (s.mesh.vertices[t[1]] - s.mesh.vertices[t[0]]));
      s.mesh.triangles[i] = {t[0], n, t[2]};
      s.mesh.triangles.push_back({n, t[1], t[2]});
    }
  }
  /// Two halves of the surface meet along a seam that each of them divides in its own way: straight on a box, bent on
  /// what is round. Corners in the seam miss one another by up to some width; along the halves' faces, or anywhere, so
  /// that loops of the rim cross themselves; sometimes no corner is common, and a loop is as long as the seam.
  void seam(damaged_solid& s) const {
    if (!s.mesh.shapes.empty()) return;  // triangles' numbers will change
    const double width = d.below(4) == 0 ? 0 : s.size() * std::pow(10, d.number(-10, -3));
    const bool in_face = d.below(2) == 0, apart = width > 0 && d.below(2) == 0;
    Eigen::AlignedBox3d box;
    for (const auto& v : s.mesh.vertices) box.extend(v);
    const clearance::vec3 n = d.direction();
    const Vector3d normal(n.x, n.y, n.z), origin = box.center() + d.number(-0.3f, 0.3f) * box.sizes();
    const auto beyond = [&](const std::array<std::uint32_t, 3>& t) {
      const auto& v = s.mesh.vertices;
      return normal.dot((v[t[0]] + v[t[1]] + v[t[2]]) / 3 - origin) > 0;
    };
    std::map<std::pair<std::uint32_t, std::uint32_t>, unsigned>
        sides;  // bit 0: of a triangle here, bit 1: of one beyond
    for (const auto& t : s.mesh.triangles)
      for (int k = 0; k < 3; ++k) sides[std::minmax(t[k], t[(k + 1) % 3])] |= beyond(t) ? 2 : 1;
    const auto off = [&](const Vector3d& along, const Vector3d& face) {
      const clearance::vec3 way = d.direction();
      Vector3d out(way.x, way.y, way.z);
      if (in_face) out = along.cross(face);
      if (!(out.norm() > 0)) return Vector3d(0, 0, 0);
      return Vector3d(d.number(-1, 1) * width / out.norm() * out);
    };
    std::map<std::uint32_t, std::uint32_t> twin;  // a corner of the seam, and the one that what is beyond has for it
    clearance::triangle_mesh made{s.mesh.vertices, {}};
    for (std::size_t i = 0; i < s.mesh.triangles.size(); ++i) {
      auto t = s.mesh.triangles[i];
      const bool there = beyond(t);
      const auto in_seam = [&](int k) { return sides[std::minmax(t[k], t[(k + 1) % 3])] == 3; };
      std::vector<std::uint32_t> ring;  // the triangle's corners, and those that divide its sides in the seam
      const Vector3d face =
          (s.mesh.vertices[t[1]] - s.mesh.vertices[t[0]]).cross(s.mesh.vertices[t[2]] - s.mesh.vertices[t[0]]);
      for (int k = 0; k < 3; ++k) {
        ring.push_back(t[k]);
        if (!in_seam(k)) continue;
        const Vector3d a = s.mesh.vertices[t[k]], b = s.mesh.vertices[t[(k + 1) % 3]];
        const unsigned cuts = unsigned(d.below(4));
        for (unsigned c = 1; c <= cuts; ++c) {
          ring.push_back(std::uint32_t(made.vertices.size()));
          made.vertices.push_back(a + (c + d.number(-0.4f, 0.4f)) / (cuts + 1.0) * (b - a) + off(b - a, face));
        }
      }
      if (there && apart)
        for (auto& v : ring)
          if (v < s.mesh.vertices.size() && touches_seam(sides, s.mesh, v)) {
            const auto [at, fresh] = twin.try_emplace(v, std::uint32_t(made.vertices.size()));
            if (fresh) made.vertices.push_back(s.mesh.vertices[v] + off(normal, face));
            v = at->second;
          }
      // A fan from a corner that is not between two divided sides would have flat triangles: from the middle it has
      // none.
      if (ring.size() == 3) {
        made.triangles.push_back({ring[0], ring[1], ring[2]});
        continue;
      }
      const auto middle = std::uint32_t(made.vertices.size());
      made.vertices.push_back((s.mesh.vertices[t[0]] + s.mesh.vertices[t[1]] + s.mesh.vertices[t[2]]) / 3);
      for (std::size_t k = 0; k < ring.size(); ++k)
        made.triangles.push_back({middle, ring[k], ring[(k + 1) % ring.size()]});
    }
    s.mesh = std::move(made);
    s.damage += 2 * width;
  }
  /// Faces are cut into needles.
  void needles(damaged_solid& s) const {
    for (int k = 0; k < 8; ++k) {
      const std::size_t i = d.below(unsigned(s.mesh.triangles.size()));
      const auto t = s.mesh.triangles[i];
      const auto n = std::uint32_t(s.mesh.vertices.size());
      const Vector3d &a = s.mesh.vertices[t[0]], &b = s.mesh.vertices[t[1]], &c = s.mesh.vertices[t[2]];
      const double at = d.number(0.1f, 0.9f), off = std::pow(10, d.number(-9, -2));
      s.mesh.vertices.push_back((1 - off) * (a + at * (b - a)) + off * c);
      s.mesh.triangles[i] = {t[0], n, t[2]};
      s.mesh.triangles.push_back({n, t[1], t[2]});
      s.mesh.triangles.push_back({t[0], t[1], n});
    }
  }
  /// A second body beside it, in it or around it, or with a face in common.
  void another_body(damaged_solid& s) const {
    Eigen::AlignedBox3d box;
    for (const auto& v : s.mesh.vertices) box.extend(v);
    const Vector3d size = box.sizes();
    const auto within = [&](double from, double to) {
      return Vector3d(box.min() +
                      size.cwiseProduct(Vector3d(d.number(float(from), float(to)), d.number(float(from), float(to)),
                                                 d.number(float(from), float(to)))));
    };
    clearance::triangle_mesh other;
    switch (d.below(4)) {
      case 0:
        other = shapes::box(box.min() + Vector3d(size.x(), 0, 0), box.max() + Vector3d(size.x(), 0, 0));
        break;  // touches
      case 1: {
        const Vector3d low = within(0.1, 0.4);
        other = shapes::box(low, low + 0.4 * size);
        break;
      }
      case 2:
        other = shapes::globe(within(0.2, 0.8), 0.4 * size.minCoeff(), 8, 10);
        break;
      default:
        other = shapes::box(box.min() - 0.2 * size, box.max() + 0.2 * size);
        break;
    }
    s.truth.bodies.push_back(other);
    if (d.below(2) == 0) other = shapes::inverted(other);
    s.mesh = shapes::merged(s.mesh, other);
  }
  /// The same as another shape of the link.
  void another_shape(damaged_solid& s) const {
    const auto own = std::uint32_t(s.mesh.triangles.size());
    another_body(s);
    s.mesh.shapes = {0, own};
  }

  using kind = void (damages::*)(damaged_solid&) const;
  static constexpr std::pair<const char*, kind> all[] = {{"another body", &damages::another_body},
                                                         {"T-joints", &damages::t_joints},
                                                         {"seam", &damages::seam},
                                                         {"needles", &damages::needles},
                                                         {"inner wall", &damages::inner_wall},
                                                         {"flipped", &damages::flipped},
                                                         {"some flipped", &damages::some_flipped},
                                                         {"doubled", &damages::doubled},
                                                         {"other diagonal", &damages::other_diagonal},
                                                         {"removed", &damages::removed},
                                                         {"cracks", &damages::cracks},
                                                         {"another shape", &damages::another_shape}};

 private:
  static bool touches_seam(const std::map<std::pair<std::uint32_t, std::uint32_t>, unsigned>& sides,
                           const clearance::triangle_mesh& mesh, std::uint32_t v) {
    return std::ranges::any_of(mesh.triangles, [&](const auto& t) {
      for (int k = 0; k < 3; ++k)
        if ((t[k] == v || t[(k + 1) % 3] == v) && sides.at(std::minmax(t[k], t[(k + 1) % 3])) == 3) return true;
      return false;
    });
  }
  static bool convex(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& e) {
    const Vector3d q[4] = {a, b, c, e};
    Vector3d normal = (c - a).cross(e - b);
    for (int k = 0; k < 4; ++k)
      if (normal.dot((q[(k + 1) % 4] - q[k]).cross(q[(k + 2) % 4] - q[(k + 1) % 4])) <= 1e-9 * normal.squaredNorm())
        return false;
    return true;
  }
  static bool touches(const clearance::triangle_mesh& gone, const std::array<std::uint32_t, 3>& t) {
    return std::ranges::any_of(gone.triangles, [&](const auto& g) {
      return std::ranges::any_of(g, [&](auto v) {
        return std::ranges::any_of(t, [&](auto w) { return (gone.vertices[v] - gone.vertices[w]).norm() <= 1e-3; });
      });
    });
  }
  /// By triangle: a number of what hangs together, by vertices that are the same or have one place.
  static std::vector<std::uint32_t> components(const clearance::triangle_mesh& m) {
    std::map<std::array<double, 3>, std::uint32_t> places;
    std::vector<std::uint32_t> above(m.vertices.size());
    for (std::uint32_t v = 0; v < above.size(); ++v)
      above[v] = places.try_emplace({m.vertices[v].x(), m.vertices[v].y(), m.vertices[v].z()}, v).first->second;
    const auto root = [&](std::uint32_t v) {
      while (above[v] != v) v = above[v] = above[above[v]];
      return v;
    };
    for (const auto& t : m.triangles) above[root(t[1])] = root(t[0]), above[root(t[2])] = root(t[0]);
    std::map<std::uint32_t, std::uint32_t> number;
    std::vector<std::uint32_t> of;
    for (const auto& t : m.triangles)
      of.push_back(number.try_emplace(root(t[0]), std::uint32_t(number.size())).first->second);
    return of;
  }
  /// Holes that touch, or nearly, are one; the diagonal of the largest's box.
  static double largest_component(const clearance::triangle_mesh& gone) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const auto& t : gone.triangles) {
      Eigen::AlignedBox3d box;
      for (const auto v : t) box.extend(gone.vertices[v]);
      boxes.push_back(box);
    }
    for (bool again = true; again;) {
      again = false;
      for (std::size_t i = 0; i < boxes.size() && !again; ++i)
        for (std::size_t j = i + 1; j < boxes.size() && !again; ++j)
          if (boxes[i].exteriorDistance(boxes[j]) <= 1e-3 * boxes[i].diagonal().norm())
            boxes[i].extend(boxes[j]), boxes.erase(boxes.begin() + std::ptrdiff_t(j)), again = true;
    }
    double most = 0;
    for (const auto& box : boxes) most = std::max(most, box.diagonal().norm());
    return most;
  }
};

/// Run number `k`: every kind by itself and every pair of them, in turn, on solids of all sorts.
inline damaged_solid damaged(unsigned k, const std::vector<clearance::triangle_mesh>& more = {}) {
  dice d(k + 1);
  constexpr std::size_t kinds = std::size(damages::all);
  damaged_solid s;
  const std::size_t solid = d.below(unsigned(6 + more.size()));
  switch (solid) {
    case 0:
      s.mesh = shapes::box({0, 0, 0}, {1, 1, 1});
      break;
    case 1:
      s.mesh = shapes::box({0, 0, 0}, {1, 0.6, 0.05});
      break;
    case 2:
      s.mesh = shapes::globe({0.1, 0.2, 0.3}, 0.5, 8, 12);
      break;
    case 3:
      s.mesh = shapes::torus(0.4, 0.15, 16, 10);
      break;
    case 4:
      s.mesh = shapes::globe({0, 0, 0}, 0.3, 4, 5);
      break;
    case 5:
      s.mesh = shapes::box({-0.1, -0.1, 0}, {0.1, 0.1, 2});
      break;
    default:
      s.mesh = more[solid - 6];
      break;
  }
  s.truth.bodies = {s.mesh};
  const damages make{d};
  const std::size_t one = k % kinds, two = k / kinds % (kinds + 1);
  for (const std::size_t kind : {std::min(one, two), std::max(one, two)}) {
    if (kind == kinds || (kind == two && one == two && s.history.size() > 0)) continue;
    (make.*damages::all[kind].second)(s);
    s.history += (s.history.empty() ? "" : " and ") + std::string(damages::all[kind].first);
  }
  return s;
}

/// Points around it, in it, and near its surface.
inline std::vector<Vector3d> probes(const damaged_solid& s, unsigned k, int count) {
  dice d(k * 7919 + 3);
  Eigen::AlignedBox3d box;
  for (const auto& v : s.mesh.vertices) box.extend(v);
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) {
    Vector3d p = box.min() + box.sizes().cwiseProduct(
                                 Vector3d(d.number(-0.1f, 1.1f), d.number(-0.1f, 1.1f), d.number(-0.1f, 1.1f)));
    if (i % 3 == 2) {
      const auto& t = s.mesh.triangles[d.below(unsigned(s.mesh.triangles.size()))];
      const clearance::vec3 way = d.direction();
      p = (s.mesh.vertices[t[0]] + s.mesh.vertices[t[1]] + s.mesh.vertices[t[2]]) / 3 +
          s.size() * std::pow(10, d.number(-5, -1)) * Vector3d(way.x, way.y, way.z);
    }
    points.emplace_back(double(float(p.x())), double(float(p.y())), double(float(p.z())));
  }
  return points;
}

}  // namespace testing
