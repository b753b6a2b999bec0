// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "progress.hpp"

#include <clearance/solid/triangle_mesh.hpp>

struct body_options {
  model_kind model = model_kind::spheres;
  std::size_t spheres = 2048;
  bool both = false;  // pack whichever the model
};

/// Closes the mesh, and packs it for the sphere model. Errors name the body.
body make_body(const std::string& name, const clearance::triangle_mesh& mesh, double tolerance,
               const body_options& options, progress& shown);
