// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "progress.hpp"

#include <clearance/solid/close_mesh.hpp>

/// A body and what was done to its mesh.
struct made_body {
  body part;
  clearance::cap_report caps;
};

struct body_options {
  model_kind model = model_kind::spheres;
  std::size_t spheres = 2048;
  bool both = false;  // spheres and triangles, whichever the model
};

/// Closes the mesh and packs it or tests its inside. Errors name the body.
made_body make_body(const std::string& name, const clearance::triangle_mesh& mesh, double tolerance,
                    const body_options& options, const progress& shown);
