// SPDX-License-Identifier: BSD-3-Clause
#include "robot_bodies.hpp"

#include <clearance/packing/pack.hpp>

#include <stdexcept>

using namespace clearance;

made_body make_body(const std::string& name, const triangle_mesh& mesh, double tolerance, const body_options& options,
                    const progress& shown) {
  made_body made;
  made.part.name = name;
  made.part.tolerance = tolerance;
  try {
    shown.show("closing " + name);
    closed_mesh closed = close_mesh(mesh);
    made.caps = closed.caps;
    if (options.model == model_kind::triangles || options.both) {
      const auto corner = [&](std::uint32_t v) {
        const Eigen::Vector3f p = closed.surface.vertices[v].cast<float>();
        return vec3{p.x(), p.y(), p.z()};
      };
      for (const auto& t : closed.surface.triangles)
        made.part.triangles.push_back(triangle::from(corner(t[0]), corner(t[1]), corner(t[2])));
      made.part.interior = make_winding<real>(closed);
    }
    if (options.model == model_kind::spheres || options.both) {
      pack_options wanted;
      wanted.count = options.spheres;
      wanted.progress = [&](std::size_t done, std::size_t of) {
        shown.show("packing " + name + ' ' + std::to_string(done) + '/' + std::to_string(of));
      };
      packing packed = pack(mesh_solid(std::move(closed)), wanted);
      if (packed.spheres.empty()) throw std::invalid_argument("no sphere fits inside: " + packed.reason());
      made.part.gap = packed.gap;
      made.part.spheres = std::move(packed.spheres);
    }
  } catch (const std::invalid_argument& error) {
    std::string why = error.what();
    if (why.starts_with("clearance: ")) why.erase(0, 11);
    throw std::runtime_error("link \"" + name + "\": " + why);
  }
  return made;
}
