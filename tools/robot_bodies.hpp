// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "progress.hpp"

#include <clearance/io/packing_cache.hpp>
#include <clearance/solid/triangle_mesh.hpp>

/// What to make a body of.
struct body_source {
  std::string name;
  const clearance::triangle_mesh* mesh;
  double tolerance = 0;                               // how far the true surface may be from the mesh, m
  const clearance::io::packed_part* given = nullptr;  // of a file: used if made for this mesh, else proven anew
};

struct body_options {
  model_kind model = model_kind::spheres;
  clearance::pack_options pack = {};  // .count spheres per body; progress is also shown
  bool both = false;                  // pack for both models
  bool sheets = true;                 // a body without inside gets spheres along its surface; otherwise it is refused
  bool on_device = false;             // pack on the device: faster, but other spheres than the host's
  clearance::io::packing_cache cache = {};
};

/// How the bodies got their spheres.
struct body_account {
  std::vector<bool> cached;  // by body: from the cache
  std::size_t packed = 0, from_cache = 0, certified = 0, proven = 0;
  double largest_gap = 0, largest_excess = 0;  // of those proven anew, metres
  std::vector<std::string> notes = {};         // to show to the user
};

/// Closes the meshes, and packs them side by side for the sphere model. Errors name the body.
std::vector<body> make_bodies(const std::vector<body_source>& sources, const body_options& options, progress& shown,
                              body_account& account);

/// The cache according to --no-cache and --cache; by default the usual one.
clearance::io::packing_cache chosen_cache(bool none, const std::string& folder);
