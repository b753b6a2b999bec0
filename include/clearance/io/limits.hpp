// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How much a mesh file may take before it is refused, because a small file can unfold to a large mesh.

#include <cstdint>

namespace clearance::io {

/// How much one mesh file, or all files of one robot together, may use: a small file can unfold to a large mesh. Beyond
/// a limit, a file is refused with a sentence that names the limit. `values` also holds for spheres in YAML.
struct mesh_limits {
  std::uint64_t bytes = std::uint64_t(256) << 20;  ///< All files that are read, together.
  std::uint64_t triangles = 5'000'000;             ///< After every instance of a mesh is placed.
  std::uint64_t values = 2'000'000;  ///< XML elements and attributes of a file, or its JSON or YAML values.
  std::uint64_t nodes = 100'000;     ///< Nodes of a scene graph; every instance counts.
  std::uint64_t depth = 100;         ///< Elements, JSON values or nodes inside one another.
};

}  // namespace clearance::io
