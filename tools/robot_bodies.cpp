// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include <clearance/packing/pack.hpp>

#include <stdexcept>

using namespace clearance;

body make_body(const std::string& name, const triangle_mesh& mesh, double tolerance, const body_options& options,
               progress& shown) {
  body made{name, {}, {}, tolerance};
  try {
    shown.show("closing " + name);
    made.closed = close_mesh(mesh);
    if (options.model == model_kind::spheres || options.both) {
      pack_options wanted;
      wanted.count = options.spheres;
      wanted.progress = [&](std::size_t done, std::size_t of) {
        shown.show("packing " + name + ' ' + std::to_string(done) + '/' + std::to_string(of));
      };
      made.packed = pack(mesh_solid(made.closed), wanted);
      if (made.packed.spheres.empty()) throw std::invalid_argument("no sphere fits inside: " + made.packed.reason());
    }
  } catch (const std::invalid_argument& error) {
    std::string why = error.what();
    if (why.starts_with("clearance: ")) why.erase(0, 11);
    throw std::runtime_error("link \"" + name + "\": " + why);
  }
  return made;
}
