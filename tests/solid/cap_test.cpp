// SPDX-License-Identifier: BSD-3-Clause
// Caps lie where the surface is missing, and faces cover what they enclose. Areas decide: no surface over a polygon has
// less than the polygon's vector area, and one that folds has more.
#include "solid/close_shape.hpp"
#include "solid/polygon.hpp"
#include "solid/shapes.hpp"
#include "support/catch.hpp"
#include "support/laws.hpp"
#include "support/random.hpp"

#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <map>

namespace cap_test {

using namespace clearance;
using Eigen::Vector3d;
using testing::dice;

namespace {

constexpr std::size_t plenty = 1'000'000'000;

polygon_triangles spanned(const std::vector<Vector3d>& vertices, std::vector<std::uint32_t> polygon = {}) {
  if (polygon.empty())
    for (std::uint32_t i = 0; i < vertices.size(); ++i) polygon.push_back(i);
  std::size_t patience = plenty;
  return span_polygon(vertices, polygon, patience);
}

/// After inner sides cancel, are the triangles' sides the polygon's?
bool has_rim(const polygon_triangles& triangles, const std::vector<std::uint32_t>& polygon) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> sides;
  const auto add = [&](std::uint32_t u, std::uint32_t v, int sign) {
    if (u != v) sides[std::minmax(u, v)] += u < v ? sign : -sign;
  };
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) add(t[k], t[(k + 1) % 3], 1);
  for (std::size_t i = 0; i < polygon.size(); ++i) add(polygon[i], polygon[(i + 1) % polygon.size()], -1);
  return std::all_of(sides.begin(), sides.end(), [](const auto& side) { return side.second == 0; });
}

/// A crack along a curve of this length and bend: both sides have corners of their own, and its ends are common.
std::vector<Vector3d> crack(dice& d, unsigned corners, double length, double bend, double width, bool crossing) {
  const auto along = [&](double t) {
    if (bend == 0) return Vector3d(length * t, 0, 0);
    const double r = length / bend;
    return Vector3d(r * std::sin(bend * t), r * (1 - std::cos(bend * t)), 0.1 * length * t * t);
  };
  const auto side = [&](double sign) {
    std::vector<double> at;
    for (unsigned i = 0; i < corners; ++i) at.push_back(d.number(0.001f, 0.999f));
    std::sort(at.begin(), at.end());
    std::vector<Vector3d> places;
    for (const double t : at) {
      const clearance::vec3 way = d.direction();
      places.push_back(along(t) + width * (crossing ? Vector3d(way.x, way.y, way.z) : Vector3d(0, 0, sign)));
    }
    return places;
  };
  std::vector<Vector3d> loop{along(0)};
  for (const Vector3d& p : side(1)) loop.push_back(p);
  loop.push_back(along(1));
  auto back = side(-1);
  loop.insert(loop.end(), back.rbegin(), back.rend());
  return loop;
}

double off_curve(const std::vector<Vector3d>& loop, const Vector3d& p) {
  double least = 1e300;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vector3d &a = loop[i], e = loop[(i + 1) % loop.size()] - a;
    const double t = e.squaredNorm() > 0 ? std::clamp((p - a).dot(e) / e.squaredNorm(), 0.0, 1.0) : 0;
    least = std::min(least, (p - a - t * e).norm());
  }
  return least;
}

}  // namespace

TEST_CASE("A polygon whose areas no number can hold is spanned all the same") {
  for (const std::uint32_t corners : {4u, 5u, 40u, 300u})  // by the least area, and zipped
    for (const double far : {1e155, 1e200, 1e300, 1.7e308}) {
      INFO(corners << " corners, one at " << far << " m");
      std::vector<Vector3d> vertices;
      std::vector<std::uint32_t> polygon;
      for (std::uint32_t i = 0; i < corners; ++i) {
        vertices.emplace_back(std::cos(6.28 * i / corners), std::sin(6.28 * i / corners), i % 3);
        polygon.push_back(i);
      }
      vertices[corners / 2] = {far, -far, 0};
      const polygon_triangles triangles = spanned(vertices);
      CHECK(triangles.size() == corners - 2);
      CHECK(has_rim(triangles, polygon));
    }
}

TEST_CASE("A crack's cap lies in the crack, however long, narrow, bent or crossing it is") {
  testing::verdict v;
  for (unsigned k = 0; k < 600; ++k) {
    dice d(k + 1);
    const unsigned corners = k % 6 == 0 ? 200 + unsigned(d.below(600)) : 1 + unsigned(d.below(40));
    const double length = 0.3, bend = k % 3 == 0 ? 0.0 : d.number(0.1f, 6);
    const double width = k % 5 == 0 ? 0 : length * std::pow(10, d.number(-9, -3));
    const std::vector<Vector3d> loop = crack(d, corners, length, bend, width, k % 2 == 0);
    std::vector<std::uint32_t> polygon(loop.size());
    for (std::uint32_t i = 0; i < polygon.size(); ++i) polygon[i] = i;
    const polygon_triangles triangles = spanned(loop);
    v.require(has_rim(triangles, polygon), "run", k, "has another rim");
    // Chords of few corners leave a bent curve.
    double chord = 0;
    for (std::size_t i = 0; i < loop.size(); ++i)
      chord = std::max(chord, (loop[(i + 1) % loop.size()] - loop[i]).norm());
    const double sagitta = bend * chord * chord / length / 8, excuse = 4 * width + 2 * sagitta + 1e-12;
    for (const auto& t : triangles)
      for (const auto& [a, b] : {std::pair{0.33, 0.33}, {0.5, 0.5}, {0.5, 0.0}, {0.0, 0.5}}) {
        const Vector3d p = loop[t[0]] + a * (loop[t[1]] - loop[t[0]]) + b * (loop[t[2]] - loop[t[0]]);
        v.require(off_curve(loop, p) <= excuse, "run", k, "of", loop.size(), "corners: off by", off_curve(loop, p), ">",
                  excuse);
      }
  }
}

TEST_CASE("A flat polygon is covered once, whatever its bays, its bridges and its holes are") {
  testing::verdict v;
  for (unsigned k = 0; k < 300; ++k) {
    dice d(k + 1);
    // A star around holes that are stars, too; each hole is joined by a bridge, with equal corners or equal places.
    std::vector<Vector3d> vertices;
    const auto star = [&](double x, double y, double size, unsigned corners) {
      std::vector<std::uint32_t> ring;
      for (unsigned i = 0; i < corners; ++i) {
        const double a = 2 * std::numbers::pi * i / corners, r = size * d.number(0.4f, 1);
        ring.push_back(std::uint32_t(vertices.size()));
        vertices.emplace_back(x + r * std::cos(a), y + r * std::sin(a), 0);
      }
      return ring;
    };
    const auto area = [&](const std::vector<std::uint32_t>& ring) { return vector_area(vertices, ring).z(); };
    const unsigned corners = k % 10 == 0 ? 500 : 30, holes = unsigned(d.below(4));
    std::vector<std::uint32_t> polygon = star(0, 0, 10, corners);
    double right = area(polygon);
    std::vector<std::vector<std::uint32_t>> rings;
    for (unsigned h = 0; h < holes; ++h) {
      rings.push_back(star(-1.6 + 1.6 * h, 0, 0.7, 3 + unsigned(d.below(k % 10 == 0 ? 100 : 12))));
      right -= area(rings.back());
      std::reverse(rings.back().begin(), rings.back().end());
      std::rotate(rings.back().begin(), rings.back().begin() + std::ptrdiff_t(d.below(unsigned(rings.back().size()))),
                  rings.back().end());
    }
    const auto turn = [&](std::uint32_t p, std::uint32_t q, std::uint32_t r) {
      return (vertices[q] - vertices[p]).cross(vertices[r] - vertices[p]).z();
    };
    const auto crosses = [&](std::uint32_t a, std::uint32_t b, const std::vector<std::uint32_t>& ring) {
      for (std::size_t i = 0; i < ring.size(); ++i) {
        const std::uint32_t p = ring[i], q = ring[(i + 1) % ring.size()];
        const auto at_end = [&](std::uint32_t c) { return vertices[c] == vertices[a] || vertices[c] == vertices[b]; };
        if (at_end(p) || at_end(q)) continue;
        if (turn(a, b, p) * turn(a, b, q) <= 0 && turn(p, q, a) * turn(p, q, b) <= 0) return true;
      }
      return false;
    };
    for (std::size_t h = 0; h < rings.size(); ++h) {  // to a corner of the outer star that the hole sees
      const std::vector<std::uint32_t>& hole = rings[h];
      std::size_t at = 0;
      const auto hidden = [&](std::size_t i) {
        const auto here = [&](std::uint32_t v) { return vertices[v] == vertices[polygon[i]]; };
        if (polygon[i] >= corners || std::count_if(polygon.begin(), polygon.end(), here) != 1) return true;
        if (crosses(polygon[i], hole[0], polygon)) return true;
        return std::any_of(rings.begin() + std::ptrdiff_t(h), rings.end(),
                           [&](const auto& other) { return crosses(polygon[i], hole[0], other); });
      };
      while (at < polygon.size() && hidden(at)) ++at;
      if (at == polygon.size()) {
        for (std::size_t rest = h; rest < rings.size(); ++rest) right -= area(rings[rest]);  // they are turned
        break;
      }
      std::vector<std::uint32_t> bridged(polygon.begin(), polygon.begin() + std::ptrdiff_t(at) + 1);
      bridged.insert(bridged.end(), hole.begin(), hole.end());
      const bool by_place = d.below(2) == 0;  // the way back has corners of its own
      for (const std::uint32_t again : {hole[0], polygon[at]}) {
        if (by_place) vertices.push_back(Vector3d(vertices[again]));
        bridged.push_back(by_place ? std::uint32_t(vertices.size() - 1) : again);
      }
      bridged.insert(bridged.end(), polygon.begin() + std::ptrdiff_t(at) + 1, polygon.end());
      polygon = bridged;
    }
    const polygon_triangles triangles = spanned(vertices, polygon);
    v.require(has_rim(triangles, polygon), "run", k, "has another rim");
    v.require(std::abs(area_of(vertices, triangles) - right) <= 1e-9 * right, "run", k, "with", holes, "holes covers",
              area_of(vertices, triangles), "of", right);
  }
}

TEST_CASE("Looking for the least area never finds less than there is, and finds what all triangulations have") {
  testing::verdict v;
  for (unsigned k = 0; k < 200; ++k) {
    dice d(k + 1);
    std::vector<Vector3d> places;
    for (unsigned i = 0; i < 3 + k % 5; ++i) places.emplace_back(d.number(-1, 1), d.number(-1, 1), d.number(-1, 1));
    std::vector<std::uint32_t> polygon(places.size());
    for (std::uint32_t i = 0; i < polygon.size(); ++i) polygon[i] = i;
    // All triangulations, by the triangle at the last side.
    const auto all = [&](auto&& self, std::uint32_t i, std::uint32_t j) -> double {
      if (j < i + 2) return 0;
      double least = 1e300;
      for (std::uint32_t m = i + 1; m < j; ++m)
        least = std::min(least, self(self, i, m) + self(self, m, j) +
                                    (places[m] - places[i]).cross(places[j] - places[i]).norm() / 2);
      return least;
    };
    const double least = all(all, 0, std::uint32_t(places.size() - 1));
    const polygon_triangles found = detail::least_area(places, polygon);
    v.require(std::abs(area_of(places, found) - least) <= 1e-12, "run", k, area_of(places, found), least);
    v.require(has_rim(found, polygon) && has_rim(detail::zipped(places, polygon), polygon), "run", k,
              "has another rim");
    v.require(area_of(places, detail::zipped(places, polygon)) >= least - 1e-12, "run", k);
    v.require(vector_area(places, polygon).norm() <= least + 1e-12, "run", k);
  }
}

TEST_CASE("The end of a pipe with a wall is closed by a ring, and its bore stays free") {
  for (const double recess : {0.0, 1e-4}) {
    triangle_mesh pipe;  // closed at the bottom, without the ring at the top
    constexpr int n = 24;
    for (const double r : {0.1, 0.08})
      for (const double z : {0.0, 0.3})
        for (int i = 0; i < n; ++i) {
          const double a = 2 * std::numbers::pi * i / n;
          pipe.vertices.emplace_back(r * std::cos(a), r * std::sin(a), z - (r < 0.1 && z > 0 ? recess : 0));
        }
    const auto at = [](int ring, int i) { return std::uint32_t(ring * n + i % n); };
    for (int i = 0; i < n; ++i) {
      const auto wall = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t e) {
        pipe.triangles.push_back({a, b, c});
        pipe.triangles.push_back({a, c, e});
      };
      wall(at(0, i), at(0, i + 1), at(1, i + 1), at(1, i));
      wall(at(2, i + 1), at(2, i), at(3, i), at(3, i + 1));
      wall(at(0, i + 1), at(0, i), at(2, i), at(2, i + 1));
    }
    const closed_mesh m = close_mesh(pipe);
    CHECK(m.caps.loops == 1);
    CHECK(m.inside == inside_by::caps);
    CHECK(m.caps.area == Approx(n * std::sin(2 * std::numbers::pi / n) / 2 * (0.01 - 0.0064)).epsilon(0.01));
    const auto w = make_winding(m);
    CHECK_FALSE(w.view().inside(vec3{0, 0, 0.2f}));
    CHECK(w.view().inside(vec3{0.09f, 0, 0.2f}));
    CHECK(mesh_solid(m).distance({0, 0, 0.31}) > 0.079);  // not at the bore's mouth, a centimetre below
  }
}

TEST_CASE("A cap that would hang in free space is none: the body stays open, and a flood says what it encloses") {
  // A box with a slit around three of its sides whose two lips were joined wrongly: the rim goes out to a far corner.
  triangle_mesh mesh = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto far = std::uint32_t(mesh.vertices.size());
  mesh.vertices.emplace_back(3, 0.5, 0.5);
  mesh.vertices.emplace_back(3, 0.5, 0.5001);
  mesh.vertices.emplace_back(3, 0.51, 0.5001);
  // A needle that goes from a corner of the box to a far place and back, open along its length.
  mesh.triangles.push_back({1, far, far + 1});
  mesh.triangles.push_back({1, far + 1, far + 2});
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.inside != inside_by::nothing);
  const auto w = make_winding(m);
  CHECK(w.view().inside(vec3{.5f, .5f, .5f}));
  CHECK_FALSE(w.view().inside(vec3{2, .5f, .7f}));
  const mesh_solid solid(m);
  CHECK(solid.distance({2, 0.5, 2}) > 1.3);
}

TEST_CASE("Two halves that meet in a bent seam leave nothing free between their caps") {
  testing::verdict v;
  unsigned apart = 0;
#if defined(CLEARANCE_SANITIZED)
  constexpr unsigned runs = 8;  // each is a flood
#else
  constexpr unsigned runs = 40;
#endif
  for (unsigned k = 0; k < runs; ++k) {
    dice d(k + 1);
    const Vector3d corner[4] = {{0, 0, 0.5}, {1, 0, 0.5}, {1, 1, 0.5}, {0, 1, 0.5}};
    double bend[4];
    for (int i = 0; i < 4; ++i) bend[i] = (i % 2 ? 1 : -1) * d.number(0, 0.3f);
    triangle_mesh mesh;
    // From the seam, which each half divides in its own way, to the end at this height.
    const auto half = [&](double end, double off, bool turned) {
      const auto first = std::uint32_t(mesh.vertices.size());
      for (int i = 0; i < 4; ++i) {
        const Vector3d a = corner[i] + Vector3d(0, 0, bend[i]),
                       b = corner[(i + 1) % 4] + Vector3d(0, 0, bend[(i + 1) % 4]);
        const int cuts = 1 + int(d.below(4));
        for (int c = 0; c < cuts; ++c) {
          const Vector3d p = a + (c + (c > 0 ? d.number(-0.4f, 0.4f) : 0)) / cuts * (b - a);
          mesh.vertices.push_back(p + Vector3d(0, 0, off)), mesh.vertices.emplace_back(p.x(), p.y(), end);
        }
      }
      const auto middle = std::uint32_t(mesh.vertices.size());
      mesh.vertices.emplace_back(0.5, 0.5, end);
      for (std::uint32_t i = first; i < middle; i += 2) {
        const std::uint32_t on = i + 2 < middle ? i + 2 : first;
        for (std::array<std::uint32_t, 3> t : {std::array{i, on, on + 1}, {i, on + 1, i + 1}, {i + 1, on + 1, middle}})
          turned ? std::swap(t[1], t[2]) : void(), mesh.triangles.push_back(t);
      }
    };
    const double off = k % 3 == 0 ? 0 : 1e-4 * d.number(0, 1);
    half(0, 0, k % 2 == 0), half(1, off, k % 4 < 2);
    const closed_mesh m = close_mesh(mesh);
    apart += m.inside == inside_by::flood;
    const auto w = make_winding<double>(m);
    for (int i = 0; i < 200; ++i) {
      const double deep = m.tolerance + 2 * off + 1e-6;
      const Vector3d p(d.number(0, 1), d.number(0, 1), d.number(0, 1));
      if ((p.array() < deep).any() || (p.array() > 1 - deep).any()) continue;
      v.require(w.view().inside(p.x(), p.y(), p.z()), "run", k, to_string(m.inside), ": free at", p.x(), p.y(), p.z());
    }
    v.require(!w.view().inside(1.1, 0.5, 0.5), "run", k, ": not free outside");
  }
  v.require(4 * apart > runs, "too few caps part:", apart);
}

TEST_CASE("A room whose seams are narrower than the tolerance is inside, however its panels meet") {
  testing::verdict v;
  std::size_t decided = 0;
  for (unsigned k = 0; k < 40; ++k) {
    dice d(k + 1);
    // A tube of panels with seams between them, and lids that do not touch it, turned anyhow.
    const int panels = 2 + int(d.below(5));
    const double radius = 0.1, height = d.number(0.1f, 0.4f), seam = d.number(0.0001f, 0.0045f);
    const clearance::vec3 way = d.direction();
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), Vector3d(way.x, way.y, way.z));
    triangle_mesh mesh;
    const auto sheet = [&](auto place, int columns, int rows) {
      const auto first = std::uint32_t(mesh.vertices.size());
      for (int i = 0; i <= columns; ++i)
        for (int j = 0; j <= rows; ++j) mesh.vertices.push_back(turn * place(double(i) / columns, double(j) / rows));
      for (int i = 0; i < columns; ++i)
        for (int j = 0; j < rows; ++j) {
          const auto at = [&](int a, int b) {
            return std::uint32_t(first + std::uint32_t((i + a) * (rows + 1) + j + b));
          };
          mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
          mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
        }
    };
    for (int p = 0; p < panels; ++p) {
      const double gap = seam / radius, from = 2 * std::numbers::pi * p / panels + gap / 2,
                   to = 2 * std::numbers::pi * (p + 1) / panels - gap / 2;
      sheet(
          [&](double u, double t) {
            const double a = from + u * (to - from);
            return Vector3d(radius * std::cos(a), radius * std::sin(a), t * height);
          },
          12, 1);
    }
    for (const double z : {-seam, height + seam})
      sheet(
          [&](double u, double t) {
            const double a = 2 * std::numbers::pi * u;
            return Vector3d((radius + 0.001) * t * std::cos(a), (radius + 0.001) * t * std::sin(a), z);
          },
          36, 1);
    const closed_mesh m = close_mesh(mesh);
    if (m.tolerance <= seam * 1.01 + 1e-4) continue;  // wider than it promises
    ++decided;
    const auto w = make_winding<double>(m);
    const mesh_solid solid = mesh_solid::of_surface(m);
    for (int i = 0; i < 20; ++i) {
      const double r = d.number(0, 0.99f) * (radius * std::cos(std::numbers::pi / 12) - m.tolerance - seam),
                   a = d.number(0, 6.28f), z = height / 2 + d.number(-0.49f, 0.49f) * (height - 2 * m.tolerance);
      const Vector3d p = turn * Vector3d(r * std::cos(a), r * std::sin(a), z), out = turn * Vector3d(0.15, 0, z);
      if (solid.distance(p) > m.tolerance)  // of a cap, too, over a panel that is bent far
        v.require(w.view().inside(p.x(), p.y(), p.z()), "run", k, ":", panels, "panels, seam", seam, "tolerance",
                  m.tolerance, ": free inside at", r, z, "of", height);
      v.require(!w.view().inside(out.x(), out.y(), out.z()), "run", k, ": not free outside");
    }
  }
  v.require(decided >= 10, "too few rooms decide:", decided);
}

TEST_CASE("Sheets beside a closed body are counted, so that somebody can be told") {
  triangle_mesh mesh = shapes::box({0.45, 0.45, 0.45}, {0.55, 0.55, 0.55});
  CHECK(close_mesh(mesh).sheets == 0);
  for (int axis = 0; axis < 3; ++axis)
    for (const double at : {0.0, 1.0}) {  // each a shape of its own
      mesh.shapes.push_back(std::uint32_t(mesh.triangles.size()));
      const auto v = std::uint32_t(mesh.vertices.size());
      for (int k = 0; k < 4; ++k) {
        Vector3d p;
        p[axis] = at, p[(axis + 1) % 3] = k == 1 || k == 2, p[(axis + 2) % 3] = k > 1;
        mesh.vertices.push_back(p);
      }
      mesh.triangles.push_back({v, v + 1, v + 2});
      mesh.triangles.push_back({v, v + 2, v + 3});
    }
  mesh.shapes.insert(mesh.shapes.begin(), 0);
  const closed_mesh m = close_mesh(mesh);
  CHECK(m.inside == inside_by::closed);
  CHECK(m.sheets == 6);
}

}  // namespace cap_test
