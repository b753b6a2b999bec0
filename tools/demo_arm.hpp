// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The arm of the demonstration, built by code.

#include <clearance/solid/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

struct demo_part {
  std::string name;
  clearance::triangle_mesh mesh;  // closed, facing out, in the part's own frame
  Eigen::Isometry3d pose;         // world-from-part
};

/// Adds a barrel around z from `bottom` to `top`, with rounded rims, to `mesh` at `place`: 864 triangles.
inline void add_barrel(clearance::triangle_mesh& mesh, const Eigen::Isometry3d& place, double bottom, double top,
                       double radius, double rim) {
  constexpr std::uint32_t sides = 36, rings = 12;
  const auto first = std::uint32_t(mesh.vertices.size());
  for (std::uint32_t k = 0; k < rings; ++k) {  // six rings on each rim, from the bottom up
    const double angle = (k < rings / 2 ? -5.0 + k : k - 6.0) / 5 * std::numbers::pi / 2;
    const double r = radius - rim + rim * std::cos(angle);
    const double z = (k < rings / 2 ? bottom + rim : top - rim) + rim * std::sin(angle);
    for (std::uint32_t i = 0; i < sides; ++i) {
      const double turn = 2 * std::numbers::pi * i / sides;
      mesh.vertices.push_back(place * Eigen::Vector3d(r * std::cos(turn), r * std::sin(turn), z));
    }
  }
  const auto last = std::uint32_t(mesh.vertices.size());
  mesh.vertices.push_back(place * Eigen::Vector3d(0, 0, bottom));
  mesh.vertices.push_back(place * Eigen::Vector3d(0, 0, top));
  for (std::uint32_t i = 0; i < sides; ++i) {
    const std::uint32_t a = first + i, b = first + (i + 1) % sides;
    mesh.triangles.push_back({last, b, a});
    for (std::uint32_t k = 0; k + 1 < rings; ++k) {
      const std::uint32_t low = k * sides, high = low + sides;
      mesh.triangles.push_back({a + low, b + low, b + high});
      mesh.triangles.push_back({a + low, b + high, a + high});
    }
    const std::uint32_t high = (rings - 1) * sides;
    mesh.triangles.push_back({last + 1, a + high, b + high});
  }
}

/// Seven parts of 1,728 triangles each, joined by six joints, leaning over the objects in front.
inline std::vector<demo_part> make_demo_arm() {
  struct link {
    const char* name;
    double length, radius;  // of the barrel along z
    double joint_radius;    // of the barrel across, at the far end
    char axis;              // of the joint below
    double degrees;
  };
  constexpr link links[7] = {
      {"base", 0.30, 0.095, 0.090, 'z', 0},       {"shoulder", 0.16, 0.075, 0.080, 'z', 12},
      {"upper arm", 0.35, 0.062, 0.072, 'y', 20}, {"forearm", 0.32, 0.054, 0.060, 'y', 75},
      {"wrist", 0.12, 0.045, 0.050, 'z', 8},      {"flange", 0.10, 0.042, 0.044, 'y', 25},
      {"hand", 0.13, 0.036, 0.040, 'z', -10},
  };

  std::vector<demo_part> arm;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (const link& l : links) {
    pose.rotate(Eigen::AngleAxisd(l.degrees * std::numbers::pi / 180,
                                  l.axis == 'z' ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY()));
    clearance::triangle_mesh mesh;
    const bool hand = std::string(l.name) == "hand";
    const Eigen::Isometry3d along = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d across(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
    across.pretranslate(Eigen::Vector3d(0, 0, hand ? l.length - 0.045 : l.length));
    add_barrel(mesh, along, 0, l.length, l.radius, 0.012);
    add_barrel(mesh, across, hand ? -0.06 : -l.joint_radius, hand ? 0.06 : l.joint_radius, l.joint_radius, 0.012);
    arm.push_back({l.name, std::move(mesh), pose});
    pose.translate(Eigen::Vector3d(0, 0, l.length));
  }
  return arm;
}
