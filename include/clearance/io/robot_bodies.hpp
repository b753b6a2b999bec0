// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// From the meshes of a robot's links to bodies: closed solids, and spheres that stand for them.

#include <clearance/ground/borrowed.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/solid/close_mesh.hpp>

#include <functional>
#include <string>
#include <vector>

namespace clearance::io {

/// One rigid body: what its models are built from.
struct body {
  std::string name;
  packing packed;        ///< For spheres; empty if not needed.
  closed_mesh closed;    ///< For triangles.
  double tolerance = 0;  ///< How far the true surface may be from the mesh, metres.
};

/// What to make a body of.
struct body_source {
  std::string name;
  const triangle_mesh* mesh;
  double tolerance = 0;                ///< How far the true surface may be from the mesh, metres.
  const packed_part* given = nullptr;  ///< Spheres of a file: used if made for this mesh, else proven anew.
};

struct body_options {
  bool spheres = true;     ///< Also pack each body; otherwise its triangles are all that is needed.
  pack_options pack = {};  ///< `count` spheres per body.
  bool sheets = true;      ///< A body without inside gets spheres along its surface; otherwise it is refused.
  packing_cache cache = {};
  borrowed_text maker = "host";  ///< What `make` is, for the cache; a device's makes other spheres than the host's.
  pack_by make = {};
  /// Is told what is being done, such as "packing 7 links: 3 done, 6200/14336 spheres". One call at a time, from any
  /// thread.
  std::function<void(const std::string&)> doing = [](const std::string&) {};
};

/// How the bodies got their spheres.
struct body_account {
  std::vector<bool> cached;  ///< For each body: did its spheres come from the cache?
  std::size_t packed = 0, from_cache = 0, certified = 0, proven = 0;
  double largest_gap = 0, largest_excess = 0;  ///< The largest of the spheres proven anew, metres.
  std::vector<std::string> notes = {};         ///< To show to the user.
};

/// Closes the meshes, and packs them side by side for the sphere model. Throws std::runtime_error, which names the
/// link.
std::vector<body> make_bodies(const std::vector<body_source>& sources, const body_options& options,
                              body_account& account);

}  // namespace clearance::io
