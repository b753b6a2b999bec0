// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace clearance::io {

/// How much one mesh file, or all files of one robot together, may ask for: a small file can unfold to a large mesh.
/// What is beyond a limit is refused with a sentence that names it.
struct mesh_limits {
  std::uint64_t bytes = std::uint64_t(256) << 20;  ///< Of all files that are read.
  std::uint64_t triangles = 5'000'000;             ///< After every instance of a mesh is in its place.
  std::uint64_t values = 2'000'000;                ///< XML elements and attributes of a file, or values of its JSON.
  std::uint64_t nodes = 100'000;                   ///< Places of a scene graph, instances counted each time.
  std::uint64_t depth = 100;                       ///< Elements, JSON values or nodes inside one another.
};

}  // namespace clearance::io
