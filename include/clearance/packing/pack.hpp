// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/packer.hpp>
#include <clearance/packing/side_by_side.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <ranges>

namespace clearance {

/// Packs spheres into a solid. The same options and seed give the same packing on any number of threads. Throws
/// std::invalid_argument for options or bounds that make no sense.
template <solid S>
packing pack(const S& s, const pack_options& options = {}) {
  packing made;
  for_each_packing(1, options.threads, [&](std::size_t) {
    const host on;
    host_steps steps(on);
    made = packer<host, host_steps, S>(on, steps, s, options).run();
  });
  return made;
}

/// Closes the mesh first; throws std::invalid_argument if it has no inside.
inline packing pack(const triangle_mesh& mesh, const pack_options& options = {}) {
  return pack(mesh_solid(mesh), options);
}

/// A range of solids, or of meshes.
template <class R>
concept packable_range =
    std::ranges::random_access_range<R> && std::ranges::sized_range<R> &&
    (solid<std::ranges::range_value_t<R>> || std::constructible_from<mesh_solid, std::ranges::range_reference_t<R>>);

/// Calls `make(solid, options)` for several solids, or for the solids in meshes, side by side.
template <class R, class Make>
  requires packable_range<const R>
std::vector<packing> pack_each(const R& solids, const pack_options& options, const Make& make) {
  const auto first = std::ranges::begin(solids);
  return side_by_side(std::size_t(std::ranges::size(solids)), options, [&](std::size_t i, const pack_options& own) {
    decltype(auto) element = first[std::ranges::range_difference_t<const R>(i)];
    if constexpr (solid<std::ranges::range_value_t<R>>)
      return make(element, own);
    else
      return make(mesh_solid(element), own);
  });
}

/// Packs several solids side by side, such as a robot's links: the same packings as one by one, sooner. `seconds`
/// applies to each; `progress` counts all spheres. Each element is read once, from any thread. Throws solid_error for
/// the first bad one.
template <class R>
  requires packable_range<const R>
std::vector<packing> pack(const R& solids, const pack_options& options = {}) {
  return pack_each(solids, options, [](const auto& s, const pack_options& own) { return pack(s, own); });
}

}  // namespace clearance
