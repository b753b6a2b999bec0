// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"
#include "progress.hpp"

#include <clearance/io/robot_bodies.hpp>

using clearance::io::body_account;
using clearance::io::body_options;
using clearance::io::body_source;

/// The library's, which shows what it does on the terminal.
inline std::vector<body> make_bodies(const std::vector<body_source>& sources, body_options options, progress& shown,
                                     body_account& account) {
  options.doing = [&](const std::string& what) { shown.show(what); };
  return clearance::io::make_bodies(sources, options, account);
}

/// How far the true surface may be from the model's, or may enclose other room, in metres.
inline double tolerance_of(const body& made, model_kind model) {
  return made.tolerance + (model == model_kind::spheres ? made.packed.tolerance : made.closed.tolerance);
}

/// The cache according to --no-cache and --cache; by default the usual one.
clearance::io::packing_cache chosen_cache(bool none, const std::string& folder);
