// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From bodies to a robot: spheres, meshes or other primitives become parts with trees.

#include <clearance/bvh/build.hpp>
#include <clearance/packing/packing.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/robot/part.hpp>
#include <clearance/solid/winding.hpp>

#include <ranges>

namespace clearance {

struct part_options {
  build_options build = {};
  double tolerance = 0;   ///< Metres by which the solid may differ from the true surface, either way (tessellation).
  bool certified = true;  ///< False: the solid is unknown (an open mesh without caps), so there is no lower bound.
};

namespace detail {

/// A sum of tolerances hides a negative one.
inline double tolerance_with(const part_options& options, double of_body) {
  check_length(options.tolerance, "the tolerance of a part");
  check_length(of_body, "the tolerance of a body");
  return options.tolerance + of_body;
}

}  // namespace detail

/// Inner spheres: signed distances, and the packing's gap and tolerance in the bracket.
template <class V, class Fit = wrapped>
auto make_part(const packing& spheres, const part_options& options = {}, Fit fit = {}) {
  return make_part(build<V>(spheres.spheres, options.build, fit), options.certified ? spheres.gap : infinity,
                   detail::tolerance_with(options, spheres.tolerance));
}

/// Triangles, caps among them: exact distances outside, 0 inside. Primitive i is triangle i as loaded; caps come after.
/// An open mesh has no inside, and no certificate. The mesh's own tolerance is added.
template <class V, class Fit = wrapped>
auto make_part(const closed_mesh& mesh, const part_options& options = {}, Fit fit = {}) {
  check(mesh);
  const auto corner = [&](std::uint32_t i) {
    const Eigen::Vector3d& v = mesh.surface.vertices[i];
    return vec3{real(v.x()), real(v.y()), real(v.z())};
  };
  std::vector<triangle> triangles;
  for (const auto& t : mesh.surface.triangles)
    triangles.push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
  const bool certain = options.certified && mesh.closed;
  auto surface = make_part(build<V>(triangles, options.build, fit), certain ? 0 : infinity,
                           detail::tolerance_with(options, mesh.tolerance));
  winding<> interior;
  if (mesh.closed) {
    interior = make_winding(mesh);
  } else {
    for (int k = 0; k < 3; ++k) {
      interior.grid.low[k] = infinity;
      interior.grid.high[k] = -infinity;
    }
  }
  return part<bvh<V, triangle>, winding<>>{std::move(surface.tree), std::move(interior), surface.facts};
}

/// Primitives of any kind; they are the whole solid.
template <class V, primitive P, class Fit = wrapped>
auto make_part(const std::vector<P>& primitives, const part_options& options = {}, Fit fit = {}) {
  return make_part(build<V>(primitives, options.build, fit), options.certified ? 0 : infinity, options.tolerance);
}

/// A robot with one part for each body, in the given order. Bodies are packings, closed meshes, or vectors of
/// primitives; `V` is the volume of their trees; `options` are the same for all, or `options(k)` gives those of body k.
/// Throws std::invalid_argument if there is no body, or an empty one.
template <class V, std::ranges::forward_range Bodies, class Options = part_options>
auto make_model(const Bodies& bodies, const Options& options = {}) {
  const auto of = [&](std::size_t k) -> part_options {
    if constexpr (std::is_invocable_v<const Options&, std::size_t>)
      return options(k);
    else
      return options;
  };
  std::vector<decltype(make_part<V>(*std::ranges::begin(bodies), part_options{}))> parts;
  for (const auto& body : bodies) parts.push_back(make_part<V>(body, of(parts.size())));
  return model(std::move(parts));
}

}  // namespace clearance
