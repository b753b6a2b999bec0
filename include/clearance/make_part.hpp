// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/bvh/build.hpp>
#include <clearance/model.hpp>
#include <clearance/packing/packing.hpp>
#include <clearance/part.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/solid/winding.hpp>

namespace clearance {

struct part_options {
  build_options build = {};
  double tolerance = 0;    ///< Metres by which the solid may differ from the true surface, either way (tessellation).
  bool certified = true;   ///< False: the solid is not known (an open mesh without caps), so no lower bound is claimed.
};

/// Inner spheres: signed distances, and the packing's gap in the bracket.
template <class V, class Fit = wrapped>
auto make_part(const packing& spheres, const part_options& options = {}, Fit fit = {}) {
  return make_part(build<V>(spheres.spheres, options.build, fit), options.certified ? spheres.gap : infinity, options.tolerance);
}

/// Triangles, caps among them: exact distances outside, 0 inside. Primitive i is triangle i as loaded; caps come after.
/// An open mesh has no inside, and no certificate.
template <class V, class Fit = wrapped>
auto make_part(const closed_mesh& mesh, const part_options& options = {}, Fit fit = {}) {
  const auto corner = [&](std::uint32_t i) {
    const Eigen::Vector3d& v = mesh.surface.vertices[i];
    return vec3{real(v.x()), real(v.y()), real(v.z())};
  };
  std::vector<triangle> triangles;
  for (const auto& t : mesh.surface.triangles) triangles.push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
  const bool certain = options.certified && mesh.closed;
  auto surface = make_part(build<V>(triangles, options.build, fit), certain ? 0 : infinity, options.tolerance);
  winding<> interior;
  if (mesh.closed)
    interior = make_winding(mesh);
  else
    for (int k = 0; k < 3; ++k) interior.grid.low[k] = infinity, interior.grid.high[k] = -infinity;
  return part<bvh<V, triangle>, winding<>>{std::move(surface.tree), std::move(interior), surface.facts};
}

/// The parts of a robot, one a packing or one a mesh, in the order given.
template <class V, class Source>
auto make_model(const std::vector<Source>& sources, const part_options& options = {}) {
  std::vector<decltype(make_part<V>(sources[0], options))> parts;
  for (const Source& s : sources) parts.push_back(make_part<V>(s, options));
  return model(std::move(parts));
}

}  // namespace clearance
