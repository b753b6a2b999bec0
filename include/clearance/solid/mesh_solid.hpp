// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A closed mesh as a solid that can be packed, on host and device.

#include <clearance/solid/box_tree.hpp>
#include <clearance/solid/close_mesh.hpp>
#include <clearance/solid/exact_triangle.hpp>
#include <clearance/solid/solid.hpp>
#include <clearance/solid/winding.hpp>

#include <limits>
#include <utility>

namespace clearance {

/// Searches in a mesh solid, on host and device.
struct mesh_solid_view {
  box_tree_view tree;
  const exact_triangle* triangles;
  basic_winding_view<double> winding;

  /// The distance to the surface if it is below `within`, else `within`. Stops early at any upper bound of at most
  /// `enough`.
  CLEARANCE_HD double distance(const vec3d& p, double within, double enough = 0) const {
    return tree.nearest(
        p, within, [this, &p](std::uint32_t i, double best) { return triangles[i].nearer(p, best); }, enough);
  }
  /// The same for eight places side by side; `within` of each becomes its distance.
  void distances(const eighths& p, eight& within) const {
    tree.nearest(p, within.largest_above(0), [this, &p, &within](std::uint32_t i, double) {
      triangles[i].nearer(p, within);
      return within.largest_above(0);
    });
  }
  CLEARANCE_HD bool inside(const vec3d& p) const { return winding.inside(p.x, p.y, p.z); }
  CLEARANCE_HD bool porous() const { return winding.enclosed != nullptr; }

  /// Calls take(i) for each triangle that is closer to p than `reach`.
  CLEARANCE_CALLS_ANYTHING
  template <class F>
  CLEARANCE_HD void near(const vec3d& p, double reach, F take) const {
    tree.nearest(p, reach, [&](std::uint32_t i, double best) {
      if (triangles[i].nearer(p, best) < best) take(i);
      return best;
    });
  }
  CLEARANCE_HD double nearer(std::uint32_t i, const vec3d& p, double best) const {
    return triangles[i].nearer(p, best);
  }
};

/// Owns what the view of a mesh solid reads, in the memory of backend B.
template <backend B>
struct mesh_solid_copy {
  template <class T>
  using buffer = typename B::template buffer<T>;

  buffer<box_pair> nodes;
  buffer<std::uint32_t> order;
  buffer<exact_triangle> triangles;
  basic_winding<double, B> winding;
  std::uint32_t items, root;

  mesh_solid_view view() const { return {{nodes.data(), order.data(), items, root}, triangles.data(), winding.view()}; }
};

/// The solid inside a closed mesh, in double: exact distances to its surface with caps, and the inside that close_mesh
/// found. Surfaces inside overlapping shells count as surface, so no sphere crosses one. Compiled: link
/// clearance::solid.
class mesh_solid {
 public:
  /// Throws std::invalid_argument if the mesh is not closed, or has no inside, as a single sheet or a Moebius strip.
  explicit mesh_solid(closed_mesh mesh);
  explicit mesh_solid(const triangle_mesh& mesh);

  /// A solid even if the mesh encloses nothing: its surface. No sphere fits into it, but distances and gaps work.
  static mesh_solid of_surface(closed_mesh mesh) { return mesh_solid(std::move(mesh), surface_too{}); }

 private:
  struct surface_too {};
  mesh_solid(closed_mesh mesh, surface_too);

 public:
  const closed_mesh& mesh() const { return mesh_; }
  Eigen::AlignedBox3d bounds() const { return bounds_; }

  double distance(const Eigen::Vector3d& p) const { return distance(p, std::numeric_limits<double>::infinity()); }
  /// The distance if it is below `within`, else `within`; that is faster.
  double distance(const Eigen::Vector3d& p, double within) const { return view().distance(p, within); }
  bool inside(const Eigen::Vector3d& p) const { return winding_.view().inside(p.x(), p.y(), p.z()); }

  mesh_solid_view view() const { return {tree_.view(), triangles_.data(), winding_.view()}; }
  /// A copy of what searches read, where `other` runs.
  template <backend Other>
  mesh_solid_copy<Other> on(const Other& other) const {
    return {other.copy_in(tree_.nodes()),
            other.copy_in(tree_.order()),
            other.copy_in(std::span<const exact_triangle>(triangles_)),
            winding_.on(other),
            tree_.view().items,
            tree_.view().root};
  }

  double tolerance() const { return mesh_.tolerance; }
  double volume() const { return volume_; }
  /// Do shells overlap? Then some winding numbers are above 1.
  bool overlaps() const { return overlaps_; }

  const std::vector<Eigen::Vector3d>& corners() const { return mesh_.surface.vertices; }

  /// Points spread evenly by area, the same on every call.
  std::vector<Eigen::Vector3d> surface_points(std::size_t count) const;

 private:
  closed_mesh mesh_;
  basic_winding<double> winding_;
  std::vector<exact_triangle> triangles_;
  box_tree tree_;
  Eigen::AlignedBox3d bounds_;
  double volume_ = 0;
  bool overlaps_ = false;
};

/// Is there an inside for inner spheres to fill?
bool has_inside(const closed_mesh& mesh);

static_assert(solid<mesh_solid> && solid_view<mesh_solid_view>);

}  // namespace clearance
