// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Meshes built by code, for tests of solids and packings.

#include <clearance/solid/triangle_mesh.hpp>

#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

namespace shapes {

using clearance::triangle_mesh;
using Eigen::Vector3d;

/// Axis-aligned, outward.
inline triangle_mesh box(Vector3d low, Vector3d high) {
  triangle_mesh m;
  for (int i = 0; i < 8; ++i)
    m.vertices.emplace_back(i & 1 ? high.x() : low.x(), i & 2 ? high.y() : low.y(), i & 4 ? high.z() : low.z());
  m.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                 {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return m;
}

/// Around the origin.
inline triangle_mesh cube(double half) { return box({-half, -half, -half}, {half, half, half}); }

/// Latitude and longitude, outward, with shared vertices.
inline triangle_mesh globe(Vector3d center, double radius, int rings = 12, int sectors = 16) {
  triangle_mesh m;
  m.vertices.push_back(center + Vector3d(0, 0, radius));
  for (int i = 1; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const double a = std::numbers::pi * i / rings, b = 2 * std::numbers::pi * j / sectors;
      m.vertices.push_back(center +
                           radius * Vector3d(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)));
    }
  m.vertices.push_back(center - Vector3d(0, 0, radius));
  const auto at = [&](int i, int j) { return std::uint32_t(1 + (i - 1) * sectors + j % sectors); };
  const std::uint32_t last = std::uint32_t(m.vertices.size() - 1);
  for (int j = 0; j < sectors; ++j) {
    m.triangles.push_back({0, at(1, j), at(1, j + 1)});
    for (int i = 1; i + 1 < rings; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
    m.triangles.push_back({last, at(rings - 1, j + 1), at(rings - 1, j)});
  }
  return m;
}

inline triangle_mesh torus(double radius, double tube, int around = 48, int across = 24) {
  triangle_mesh m;
  for (int i = 0; i < around; ++i)
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = radius + tube * std::cos(b);
      m.vertices.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
      const auto at = [&](int u, int v) { return std::uint32_t((u % around) * across + v % across); };
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return m;
}

inline triangle_mesh moebius(int steps = 40, double radius = 1, double width = 0.4) {
  triangle_mesh m;
  for (int i = 0; i < steps; ++i) {
    const double u = 2 * std::numbers::pi * i / steps;
    for (const double v : {-width, 0.0, width}) {
      const double r = radius + v * std::cos(u / 2);
      m.vertices.emplace_back(r * std::cos(u), r * std::sin(u), v * std::sin(u / 2));
    }
  }
  for (int i = 0; i < steps; ++i)
    for (int k = 0; k < 2; ++k) {
      const auto at = [&](int row, int column) {
        return std::uint32_t(row < steps ? row * 3 + column : 2 - column);  // half a turn at the seam
      };
      m.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      m.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  return m;
}

inline triangle_mesh inverted(triangle_mesh m) {
  for (auto& t : m.triangles) std::swap(t[1], t[2]);
  return m;
}

inline triangle_mesh merged(triangle_mesh a, const triangle_mesh& b) {
  const std::uint32_t shift = std::uint32_t(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (auto t : b.triangles) {
    for (auto& v : t) v += shift;
    a.triangles.push_back(t);
  }
  return a;
}

/// Every triangle with vertices of its own, as STL files have them.
inline triangle_mesh soup(const triangle_mesh& m) {
  triangle_mesh s;
  for (const auto& t : m.triangles) {
    const std::uint32_t first = std::uint32_t(s.vertices.size());
    for (const auto v : t) s.vertices.push_back(m.vertices[v]);
    s.triangles.push_back({first, first + 1, first + 2});
  }
  return s;
}

/// Enough of binary STL for the robots in the data folder. Empty if it cannot be read.
inline triangle_mesh binary_stl(const std::string& path) {
  triangle_mesh m;
  std::ifstream file(path, std::ios::binary);
  char header[80];
  std::uint32_t count = 0;
  file.read(header, 80).read(reinterpret_cast<char*>(&count), 4);
  for (std::uint32_t i = 0; file && i < count; ++i) {
    float numbers[12];
    file.read(reinterpret_cast<char*>(numbers), 48).ignore(2);
    if (!file) break;
    for (int k = 0; k < 3; ++k) m.vertices.emplace_back(numbers[3 * k + 3], numbers[3 * k + 4], numbers[3 * k + 5]);
    m.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return m;
}

}  // namespace shapes
