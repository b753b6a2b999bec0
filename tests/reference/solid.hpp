// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A mesh as a solid, by definition: how far its surface is, and whether some body of it encloses a point. In long
// double, over a plain tree of boxes; it includes nothing of the library.

#include "reference/exact.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <random>
#include <tuple>
#include <vector>

namespace reference {

using wide = long double;
using place = vec<wide>;

enum class side : std::uint8_t { outside, inside, unknown };

class solid {
 public:
  using corners = std::array<place, 3>;

  /// Corners of triangles; `shapes` are the first triangles of those that stand alone, or empty.
  solid(std::vector<corners> faces, const std::vector<std::uint32_t>& shapes) : faces_(std::move(faces)) {
    body_.assign(faces_.size(), -1), turned_.assign(faces_.size(), 1);
    for (std::size_t k = 0; k < std::max<std::size_t>(1, shapes.size()); ++k) {
      const std::size_t first = shapes.empty() ? 0 : shapes[k];
      find_bodies(first, k + 1 < shapes.size() ? shapes[k + 1] : faces_.size());
    }
    order_.resize(faces_.size());
    for (std::uint32_t i = 0; i < order_.size(); ++i) order_[i] = i;
    if (!faces_.empty()) build(0, std::uint32_t(faces_.size()));
    for (const corners& f : faces_)
      for (const place& p : f) size_ = std::max(size_, length(p));
  }

  /// Does every body close, with two faces at each edge, so that its inside needs no rule about damage?
  bool clean() const { return clean_; }
  wide size() const { return size_; }  ///< The largest distance of a corner from the origin.
  const std::vector<corners>& faces() const { return faces_; }

  /// The distance to the surface, or `most` if that is less.
  wide surface(place q, wide most = std::numeric_limits<wide>::infinity()) const {
    visit(
        q, [&](const node& n) { return outside_of(n, q) <= double(most) * (1 + 1e-12); },
        [&](std::uint32_t i) { most = std::min(most, to_triangle(q, faces_[i][0], faces_[i][1], faces_[i][2])); });
    return most;
  }
  /// The distance of a way, 0 if it passes through the surface.
  wide surface(place from, place to, wide most) const {
    const place middle = wide(0.5) * (from + to);
    const double half = double(length(to - from)) / 2;
    visit(
        middle,
        [&](const node& n) { return outside_of(n, middle) - half <= double(most) * (1 + 1e-12) + half * 1e-12; },
        [&](std::uint32_t i) {
          most = std::min(most, segment_to_triangle(from, to, faces_[i][0], faces_[i][1], faces_[i][2]));
        });
    return most;
  }
  wide to_face(place q, std::uint32_t i) const { return to_triangle(q, faces_[i][0], faces_[i][1], faces_[i][2]); }

  /// By the crossings of a ray, of each body by itself. A ray that passes an edge too closely to be sure is not used.
  side where(place q) const {
    if (!clean_ || faces_.empty()) return side::unknown;
    if (outside_of(nodes_[0], q) > 0) return side::outside;
    std::mt19937 chance(17);
    const auto number = [&] { return wide(chance()) / 2147483648.0L - 1; };
    for (int tries = 0; tries < 30; ++tries) {
      const place way{number(), number(), number()};
      const wide l = length(way);
      if (l < 0.1L || l > 1) continue;
      bool sure = true;
      std::map<int, int> crossings;
      visit(
          q, [&](const node& n) { return sure && meets(n, q, way); },
          [&](std::uint32_t i) { sure = sure && cross_face(q, way, i, crossings); });
      if (!sure) continue;
      for (const auto& [body, count] : crossings)
        if (count != 0) return side::inside;
      return side::outside;
    }
    return side::unknown;
  }

 private:
  struct node {
    double low[3], high[3];
    std::uint32_t begin, end, left, right;  ///< A leaf has no children.
  };

  /// Bodies are connected by edges. Faces without an area in corners' numbers count for nothing.
  void find_bodies(std::size_t first, std::size_t last) {
    std::map<std::tuple<wide, wide, wide>, int> numbers;
    std::vector<std::array<int, 3>> named(last - first);
    std::map<std::pair<int, int>, std::vector<std::size_t>> at_edge;
    const auto proper = [&](std::size_t i) {
      const auto& t = named[i - first];
      return t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    };
    for (std::size_t i = first; i < last; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        const place& p = faces_[i][k];
        named[i - first][k] = numbers.try_emplace({p.x, p.y, p.z}, int(numbers.size())).first->second;
      }
      if (proper(i))
        for (std::size_t k = 0; k < 3; ++k)
          at_edge[std::minmax(named[i - first][k], named[i - first][(k + 1) % 3])].push_back(i);
    }
    for (const auto& [edge, its] : at_edge) clean_ = clean_ && its.size() == 2;
    if (!clean_) return;
    const auto goes = [&](std::size_t i, int a, int b) {  // along this edge, as it is turned?
      for (std::size_t k = 0; k < 3; ++k)
        if (named[i - first][k] == a && named[i - first][(k + 1) % 3] == b) return turned_[i] > 0;
      return turned_[i] < 0;
    };
    for (std::size_t start = first; start < last; ++start) {
      if (body_[start] >= 0 || !proper(start)) continue;
      std::vector<std::size_t> open{start};
      body_[start] = bodies_;
      wide volume = 0, area = 0;
      while (!open.empty()) {
        const std::size_t i = open.back();
        open.pop_back();
        const auto& [a, b, c] = faces_[i];
        const place o = faces_[start][0];
        volume += turned_[i] * dot(a - o, cross(b - o, c - o)) / 6, area += length(cross(b - a, c - a)) / 2;
        for (std::size_t k = 0; k < 3; ++k) {
          const int from = named[i - first][k], to = named[i - first][(k + 1) % 3];
          for (const std::size_t other : at_edge[std::minmax(from, to)]) {
            if (other == i) continue;
            if (body_[other] < 0) {
              body_[other] = bodies_, open.push_back(other);
              if (goes(other, from, to) == goes(i, from, to)) turned_[other] = -1;
            }
            clean_ = clean_ && goes(other, from, to) != goes(i, from, to);  // else it has one side only
          }
        }
      }
      clean_ = clean_ && std::abs(volume) > 1e-6L * std::pow(area, 1.5L);  // a folded sheet is no solid
      ++bodies_;
    }
  }

  std::uint32_t build(std::uint32_t begin, std::uint32_t end) {
    node n{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, begin, end, 0, 0};
    const auto middle = [&](std::uint32_t i, int k) {
      const auto along = [&](const place& p) { return k == 0 ? p.x : k == 1 ? p.y : p.z; };
      return along(faces_[i][0]) + along(faces_[i][1]) + along(faces_[i][2]);
    };
    for (std::uint32_t j = begin; j < end; ++j)
      for (const place& p : faces_[order_[j]]) {
        const wide x[3] = {p.x, p.y, p.z};
        for (int k = 0; k < 3; ++k)
          n.low[k] = std::min(n.low[k], std::nextafter(double(x[k]), -1e300)),
          n.high[k] = std::max(n.high[k], std::nextafter(double(x[k]), 1e300));
      }
    const auto me = std::uint32_t(nodes_.size());
    nodes_.push_back(n);
    if (end - begin <= 4) return me;
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (n.high[k] - n.low[k] > n.high[axis] - n.low[axis]) axis = k;
    const std::uint32_t half = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) { return middle(a, axis) < middle(b, axis); });
    const std::uint32_t left = build(begin, half), right = build(half, end);
    nodes_[me].left = left, nodes_[me].right = right;
    return me;
  }

  /// The child that is nearer to `from` comes first.
  template <class Enter, class Take>
  void visit(place from, Enter enter, Take take) const {
    if (nodes_.empty()) return;
    std::uint32_t stack[128], depth = 0;
    stack[depth++] = 0;
    while (depth != 0) {
      const node& n = nodes_[stack[--depth]];
      if (!enter(n)) continue;
      if (n.left == 0)
        for (std::uint32_t j = n.begin; j < n.end; ++j) take(order_[j]);
      else if (outside_of(nodes_[n.left], from) < outside_of(nodes_[n.right], from))
        stack[depth++] = n.right, stack[depth++] = n.left;
      else
        stack[depth++] = n.left, stack[depth++] = n.right;
    }
  }
  static double outside_of(const node& n, place q) {
    const double x[3] = {double(q.x), double(q.y), double(q.z)};
    double square = 0;
    for (int k = 0; k < 3; ++k) {
      const double d = std::max({n.low[k] - x[k], x[k] - n.high[k], 0.0});
      square += d * d;
    }
    return std::sqrt(square);
  }
  static bool meets(const node& n, place q, place way) {
    wide from = 0, to = std::numeric_limits<wide>::infinity();
    const wide x[3] = {q.x, q.y, q.z}, w[3] = {way.x, way.y, way.z};
    for (int k = 0; k < 3; ++k) {
      const wide more = 1e-9L * (std::abs(n.high[k]) + std::abs(n.low[k]) + std::abs(x[k]));
      const wide a = (n.low[k] - more - x[k]) / w[k], b = (n.high[k] + more - x[k]) / w[k];
      from = std::max(from, std::min(a, b)), to = std::min(to, std::max(a, b));
    }
    return from <= to;
  }
  /// Counts the crossing, if there is one; false if that is not sure.
  bool cross_face(place q, place way, std::uint32_t i, std::map<int, int>& crossings) const {
    if (body_[i] < 0) return true;
    const place a = faces_[i][0] - q, b = faces_[i][1] - q, c = faces_[i][2] - q;
    const wide u = dot(way, cross(b, c)), v = dot(way, cross(c, a)), w = dot(way, cross(a, b));
    const wide near = 1e-13L * (length(a) * length(b) + length(b) * length(c) + length(c) * length(a));
    const auto sign = [near](wide x) { return x > near ? 1 : x < -near ? -1 : 0; };
    const int s[3] = {sign(u), sign(v), sign(w)};
    const bool some = s[0] > 0 || s[1] > 0 || s[2] > 0, others = s[0] < 0 || s[1] < 0 || s[2] < 0;
    if (some && others) return true;  // it passes by
    if (s[0] == 0 || s[1] == 0 || s[2] == 0) return false;
    const wide ahead = dot(a, cross(b - a, c - a)) / (u + v + w);
    if (std::abs(ahead) < 1e-15L * size_) return false;
    if (ahead > 0) crossings[body_[i]] += s[0] * turned_[i];
    return true;
  }

  std::vector<corners> faces_;
  std::vector<int> body_, turned_;
  std::vector<std::uint32_t> order_;
  std::vector<node> nodes_;
  int bodies_ = 0;
  bool clean_ = true;
  wide size_ = 0;
};

}  // namespace reference
