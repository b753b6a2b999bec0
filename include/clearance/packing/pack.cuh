// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/packing/device_steps.cuh>
#include <clearance/packing/rounds.hpp>

namespace clearance {

/// Packs spheres into a mesh solid on a GPU. As on the host: spheres are proven inside and apart in double, the gap is
/// certified, and the same options and seed give the same bits on every run; but not the host's spheres, for more cells
/// are looked at before one is chosen. Throws what `pack` on the host throws, and cuda_error.
inline packing pack(const device& on, const mesh_solid& s, const pack_options& options = {}) {
  const device_guard guard(on.id);
  device_steps steps(on);
  return round_packer<device, device_steps>(on, steps, s, options).run();
}

/// Closes the mesh first; throws std::invalid_argument if it has no inside.
inline packing pack(const device& on, const triangle_mesh& mesh, const pack_options& options = {}) {
  return pack(on, mesh_solid(mesh), options);
}

template <solid S>
packing pack(const device&, const S&, const pack_options& = {}) {
  static_assert(sizeof(S) == 0,
                "on a device only mesh solids can be packed; pack others on the host: pack(solid, options)");
  return {};
}

}  // namespace clearance
