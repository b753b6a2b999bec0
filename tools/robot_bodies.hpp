// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "progress.hpp"

#include <clearance/io/packing_cache.hpp>
#include <clearance/solid/triangle_mesh.hpp>

/// What a body is made of.
struct body_source {
  std::string name;
  const clearance::triangle_mesh* mesh;
  double tolerance = 0;  // how far the true surface may be from the mesh, m
  const clearance::io::packed_part* given =
      nullptr;  // spheres of a file: taken if they are of this mesh, else proven anew
};

struct body_options {
  model_kind model = model_kind::spheres;
  clearance::pack_options pack = {};  // .count spheres a body; progress is shown as well
  bool both = false;                  // pack whichever the model
  bool sheets = true;                 // what has no inside gets spheres along its surface; else it is refused
  bool on_device = false;             // pack there: sooner, but other spheres than the host's
  clearance::io::packing_cache cache = {};
};

/// How the spheres of bodies came about.
struct body_account {
  std::vector<bool> cached;  // by body: from the cache
  std::size_t packed = 0, from_cache = 0, certified = 0, proven = 0;
  double largest_gap = 0, largest_excess = 0;  // of those that were proven anew, metres
  std::vector<std::string> notes = {};         // what a user should see
};

/// Closes the meshes, and packs them beside one another for the sphere model. Errors name the body.
std::vector<body> make_bodies(const std::vector<body_source>& sources, const body_options& options, progress& shown,
                              body_account& account);

/// The cache that --no-cache and --cache ask for; by default the usual one.
clearance::io::packing_cache chosen_cache(bool none, const std::string& folder);
