// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Fingerprints of bytes and of closed meshes: files that are kept for later are known by them.

#include <clearance/io/bytes.hpp>
#include <clearance/solid/close_mesh.hpp>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <array>

namespace clearance::io {

/// A fingerprint: 128 bits of XXH3. Equal content has equal digests; different content has equal ones by a chance of
/// about 2^-128. It does not protect against forgery. All zeros: not known.
struct digest {
  std::array<std::uint8_t, 16> bytes{};

  friend bool operator==(const digest&, const digest&) = default;
  explicit operator bool() const { return *this != digest{}; }

  std::string hex() const {
    std::string text;
    for (const std::uint8_t b : bytes) text += "0123456789abcdef"[b >> 4], text += "0123456789abcdef"[b & 15];
    return text;
  }
};

inline digest digest_of(std::string_view bytes) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits(bytes.data(), bytes.size()));
  digest made;
  for (std::size_t k = 0; k < made.bytes.size(); ++k) made.bytes[k] = canonical.digest[k];
  return made;
}

/// Covers everything that decides which points are inside: corners, triangles with their caps, which triangles count,
/// and the result of a flood.
inline digest digest_of(const closed_mesh& mesh) {
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
    for (int k = 0; k < 3; ++k) out.put(grid.low[k]), out.put(grid.size[k]);
    out.put(grid.cube);
    for (const std::uint32_t word : grid.bits) out.put(word);
  }
  return digest_of(out.bytes());
}

}  // namespace clearance::io
