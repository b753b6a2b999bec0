// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Fingerprints of bytes and of closed meshes: files that are kept for later are known by them.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace clearance {
struct closed_mesh;
}

namespace clearance::io {

/// A fingerprint: 128 bits of XXH3. Equal content has equal digests; different content has equal ones by a chance of
/// about 2^-128. It does not protect against forgery. All zeros: not known.
struct digest {
  std::array<std::uint8_t, 16> bytes{};

  friend bool operator==(const digest&, const digest&) = default;
  explicit operator bool() const { return *this != digest{}; }

  std::string hex() const {
    std::string text;
    for (const std::uint8_t b : bytes) {
      text += "0123456789abcdef"[b >> 4];
      text += "0123456789abcdef"[b & 15];
    }
    return text;
  }
};

digest digest_of(std::string_view bytes);

/// Covers everything that decides which points are inside: corners, triangles with their caps, which triangles count,
/// and the result of a flood.
digest digest_of(const closed_mesh& mesh);

}  // namespace clearance::io
