// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/backend/own_stream.cuh>
#include <clearance/packing/device_steps.cuh>
#include <clearance/packing/pack.hpp>

namespace clearance {

/// Packs spheres into a solid on a GPU: a mesh solid, or another with `on(device)`. As on the host, spheres are proven
/// inside and apart in double, the gap is certified, and the same options and seed give the same bits in every run.
/// Throws as `pack` on the host, and cuda_error.
template <solid_for<device> S>
packing pack(const device& on, const S& s, const pack_options& options = {}) {
  const device_guard guard(on.id);
  device_steps steps(on);
  return packer<device, device_steps, S>(on, steps, s, options).run();
}

/// Closes the mesh first; throws std::invalid_argument if it has no inside.
inline packing pack(const device& on, const triangle_mesh& mesh, const pack_options& options = {}) {
  return pack(on, mesh_solid(mesh), options);
}

/// Packs several solids side by side, as on the host, each on its own stream; the stream of `on` is not used.
template <class R>
  requires packable_range<const R>
std::vector<packing> pack(const device& on, const R& solids, const pack_options& options = {}) {
  return pack_each(solids, options, [&](const auto& s, const pack_options& own) {
    const own_stream stream(on.id);
    return pack(stream.on(), s, own);
  });
}

template <solid S>
packing pack(const device&, const S&, const pack_options& = {}) {
  static_assert(sizeof(S) == 0,
                "on a device only solids with on(device) can be packed; pack others on the host: pack(solid, options)");
  return {};
}

}  // namespace clearance
