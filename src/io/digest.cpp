// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/digest.hpp>

#include <clearance/io/bytes.hpp>
#include <clearance/solid/close_mesh.hpp>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>

namespace clearance::io {

digest digest_of(std::string_view bytes) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  digest made;
  for (std::size_t k = 0; k < made.bytes.size(); ++k) made.bytes[k] = canonical.digest[k];
  return made;
}

digest digest_of(const closed_mesh& mesh) {
  byte_writer out;
  const auto& vertices = mesh.surface.vertices;
  const auto& triangles = mesh.surface.triangles;
  out.reserve(64 + 24 * vertices.size() + 13 * triangles.size());
  out.put(std::string_view("clearance closed mesh"));
  out.put(std::uint64_t(vertices.size()));
  for (const auto& v : vertices)
    for (int k = 0; k < 3; ++k) out.put(v[k]);
  out.put(std::uint64_t(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const std::uint32_t v : triangles[i]) out.put(v);
    out.put(std::uint8_t(mesh.counts[i]));
  }
  out.put(std::uint8_t(mesh.closed));
  if (!mesh.enclosed.bits.empty()) {
    const enclosure_grid& grid = mesh.enclosed;
    for (int k = 0; k < 3; ++k) {
      out.put(grid.low[k]);
      out.put(grid.size[k]);
    }
    out.put(grid.cube);
    for (const std::uint32_t word : grid.bits) out.put(word);
  }
  return digest_of(out.bytes());
}

}  // namespace clearance::io
