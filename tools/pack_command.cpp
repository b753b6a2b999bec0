// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"
#include "progress.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/packing/pack.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <fstream>
#include <iostream>

using namespace clearance;

namespace {

struct pack_settings {
  std::string mesh, spheres, out;
  bool json = false;
};

const char* name_of(pack_stop stop) {
  constexpr const char* names[] = {"count", "no_room", "smallest_radius", "gap", "time", "cancelled", "search_limit"};
  return names[int(stop)];
}

/// Nine digits bring each float back exactly.
void save_spheres(const std::vector<inner_sphere>& spheres, const std::string& file) {
  std::ofstream out(file);
  if (!out) io::refuse(file, "cannot be opened for writing");
  out << "x,y,z,r\n";
  for (const inner_sphere& s : spheres) {
    char line[128];
    std::snprintf(line, sizeof line, "%.9g,%.9g,%.9g,%.9g\n", double(s.center.x), double(s.center.y), double(s.center.z), double(s.radius));
    out << line;
  }
  if (!out.flush()) io::refuse(file, "cannot be written");
}

int run(const pack_settings& asked) {
  pack_options options;
  options.count = whole_number("--spheres", asked.spheres);
  progress shown;
  options.progress = [&](std::size_t done, std::size_t of) {
    shown.show("packing " + asked.mesh + ' ' + std::to_string(done) + '/' + std::to_string(of));
  };
  shown.show("reading " + asked.mesh);
  const triangle_mesh mesh = io::load_mesh(asked.mesh);
  packing packed;
  cap_report caps;
  try {
    const mesh_solid solid(mesh);
    caps = solid.mesh().caps;
    packed = pack(solid, options);
  } catch (const std::invalid_argument& error) {
    std::string why = error.what();
    if (why.starts_with("clearance: ")) why.erase(0, 11);
    io::refuse(asked.mesh, why);
  }
  shown.clear();
  if (packed.spheres.empty()) io::refuse(asked.mesh, "no sphere fits inside: " + packed.reason());
  if (!asked.out.empty()) save_spheres(packed.spheres, asked.out);
  if (asked.json) {
    const nlohmann::ordered_json out = {{"mesh", asked.mesh},
                                        {"spheres", packed.spheres.size()},
                                        {"fill", packed.fill},
                                        {"gap", packed.gap},
                                        {"gap_mean", packed.gap_mean},
                                        {"gap_p95", packed.gap_p95},
                                        {"radius_min", packed.radius_min},
                                        {"radius_max", packed.radius_max},
                                        {"caps", {{"loops", caps.loops}, {"area", caps.area}}},
                                        {"stopped_by", name_of(packed.stopped_by)},
                                        {"seconds", packed.seconds}};
    std::cout << out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
    return 0;
  }
  char text[1024];
  std::snprintf(text, sizeof text,
                "spheres   %zu, radii %.6f to %.6f m\nfill      %.4f of the volume\n"
                "gap       %.6f m at most, %.6f m on average over the surface\ncaps      %u holes closed, %.3g m2\n",
                packed.spheres.size(), packed.radius_min, packed.radius_max, packed.fill, packed.gap, packed.gap_mean, caps.loops, caps.area);
  std::cout << text << "stopped   " << packed.reason() << '\n';
  std::snprintf(text, sizeof text, "seconds   %.3f\n", packed.seconds);
  std::cout << text;
  return 0;
}

}  // namespace

subcommand add_pack(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("pack", "Fill a mesh with inner spheres");
  auto asked = std::make_shared<pack_settings>();
  sub->add_option("MESH", asked->mesh, "STL, OBJ, PLY, OFF, DAE or GLB")->required();
  sub->add_option("--spheres", asked->spheres, "How many; fewer if no more fit")->required();
  sub->add_flag("--json", asked->json, "Print one JSON object");
  sub->add_option("--out", asked->out, "Write the spheres to this CSV file: x,y,z,r in the mesh's frame, metres");
  return [asked] { return run(*asked); };
}
