// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"
#include "json_text.hpp"
#include "kept_packings.hpp"
#include "messages.hpp"
#include "noted_files.hpp"
#include "report_text.hpp"
#include "robot_bodies.hpp"

#include <clearance/io/error.hpp>
#include <clearance/io/packing_scene.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/write_file.hpp>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>

using namespace clearance;

namespace {

struct pack_settings {
  std::string input, spheres, gap, radius, seconds, seed, geometry, cache, joints, gltf_up, backend = "host";
  std::vector<std::string> out, packages, mesh_limits, excluded;
  bool overlap = false, strict = false, no_cache = false, json = false;
};

/// What to pack: the links of a robot, or one mesh.
struct subject {
  std::vector<io::robot_part> parts;
  std::vector<Eigen::Isometry3d> poses;
  std::vector<std::string> notes;
  bool robot = false;
};

struct packed_subject {
  std::vector<body> bodies;
  std::vector<bool> cached;
  std::vector<std::string> notes;
  double seconds = 0;  // for all, side by side
};

bool ends(const std::string& file, const char* ending) { return std::filesystem::path(file).extension() == ending; }

subject load(const pack_settings& asked) {
  subject made;
  if (!ends(asked.input, ".urdf")) {
    for (const auto& [option, given] : {std::pair{"--geometry", !asked.geometry.empty()},
                                        {"--package", !asked.packages.empty()},
                                        {"--exclude-link", !asked.excluded.empty()},
                                        {"--joints", !asked.joints.empty()},
                                        {"--strict", asked.strict}})
      if (given) throw usage_error(option, "is for robots, and " + asked.input + " is none by its name");
    made.parts.push_back(
        {.name = std::filesystem::path(asked.input).stem().string(),
         .mesh = noted_mesh(asked.input, limits_of(asked.mesh_limits), gltf_axis_of(asked.gltf_up), made.notes)});
    made.poses.push_back(Eigen::Isometry3d::Identity());
    return made;
  }

  made.robot = true;
  io::robot_options options;
  if (!asked.geometry.empty() && choice("--geometry", asked.geometry, {"collision", "visual"}) == 1)
    options.geometry = io::robot_geometry::visual;
  options.packages = packages_of(asked.packages);
  options.exclude_links = asked.excluded;
  options.strict = asked.strict;
  options.gltf_up = gltf_axis_of(asked.gltf_up);
  options.limits = limits_of(asked.mesh_limits);

  const io::robot robot = io::load_robot(asked.input, options);
  const auto& tree = robot.kinematics();
  const auto joints = asked.joints.empty() ? tree.configuration({}, {}) : numbers("--joints", asked.joints);
  if (joints.size() != tree.size())
    throw usage_error("--joints", "the robot has " + std::to_string(tree.size()) + " movable joints, here are " +
                                      std::to_string(joints.size()) + " values");

  made.poses = robot.poses(joints);
  made.parts = robot.parts();
  made.notes = robot.notes();
  return made;
}

packed_subject fill(const subject& what, const pack_settings& asked, progress& shown) {
  body_options how;
  how.pack.count = whole_number("--spheres", asked.spheres);
  const auto positive = [](const char* option, const std::string& text, double& to) {
    if (text.empty()) return;
    to = number(option, text);
    if (!(to > 0)) throw usage_error(option, "must be above 0");
  };

  positive("--gap", asked.gap, how.pack.gap_target);
  positive("--smallest-radius", asked.radius, how.pack.smallest_radius);
  positive("--seconds", asked.seconds, how.pack.seconds);
  if (!asked.seed.empty()) how.pack.seed = whole_number("--seed", asked.seed);
  how.pack.allow_overlap = asked.overlap;
  how.sheets = what.robot;  // for a mesh, the user wants to know that nothing fits
  if (is_device(asked.backend)) {
    how.maker = "device";
    how.make = pack_on_device;
  }
  how.cache = chosen_cache(asked.no_cache, asked.cache);

  std::vector<body_source> sources;
  for (const io::robot_part& part : what.parts) sources.push_back({part.name, &part.mesh, part.tessellation_error});
  packed_subject made;
  stopwatch clock;
  try {
    body_account account;
    made.bodies = make_bodies(sources, how, shown, account);
    made.cached = account.cached;
    made.notes = std::move(account.notes);
  } catch (const std::runtime_error& error) {  // a single mesh is identified by its file's name
    std::string why = error.what();
    const std::string link = "link " + io::quoted(what.parts[0].name) + ": ";
    if (!what.robot && why.starts_with(link)) why.erase(0, link.size());
    io::refuse(asked.input, why);
  }
  made.seconds = clock.lap();
  return made;
}

void write(const std::string& file, const subject& what, const packed_subject& made) {
  if (ends(file, ".glb")) {
    std::vector<io::scene_packing> parts;
    for (std::size_t k = 0; k < made.bodies.size(); ++k)
      parts.push_back({made.bodies[k].name, made.bodies[k].closed.surface, made.bodies[k].packed, what.poses[k]});
    return io::save_scene(io::packing_scene(parts), file);
  }
  std::vector<io::packed_part> parts;
  for (const body& b : made.bodies)
    parts.push_back({.name = b.name,
                     .spheres = b.packed,
                     .tolerance = b.tolerance,
                     .solid = io::digest_of(b.closed),
                     .recipe = {}});
  io::save_spheres(parts, file);
}

const char* name_of(pack_stop stop) {
  constexpr const char* names[] = {"count", "no_room", "smallest_radius", "gap", "time", "cancelled", "search_limit"};
  return names[int(stop)];
}

nlohmann::ordered_json quality(const body& b, bool cached) {
  const packing& p = b.packed;
  return {{"spheres", p.spheres.size()},
          {"fill", p.fill},
          {"gap", p.gap},
          {"gap_mean", p.gap_mean},
          {"gap_p95", p.gap_p95},
          {"radius_min", p.radius_min},
          {"radius_max", p.radius_max},
          {"caps", {{"loops", b.closed.caps.loops}, {"area", b.closed.caps.area}}},
          {"inside", to_string(b.closed.inside)},
          {"tolerance", b.tolerance + p.tolerance},
          {"stopped_by", name_of(p.stopped_by)},
          {"seconds", p.seconds},
          {"cached", cached}};
}

void print_one(const body& b, bool cached) {
  const packing& p = b.packed;
  std::cout << text("spheres   %zu, radii %.6f to %.6f m\nfill      %.4f of the volume\n", p.spheres.size(),
                    p.radius_min, p.radius_max, p.fill)
            << text("gap       %.6f m at most; over the surface 95 %% within %.6f m, mean %.6f m\n", p.gap, p.gap_p95,
                    p.gap_mean)
            << text("caps      %u holes closed, %.3g m2\n", b.closed.caps.loops, b.closed.caps.area) << "stopped   "
            << p.reason() << '\n'
            << text("seconds   %.3f%s\n", p.seconds, cached ? ", when it was packed; this is from the cache" : "");
}

void print_all(const packed_subject& made) {
  std::size_t widest = 4, cached = 0, spheres = 0;
  double fill = 0, mean = 0, p95 = 0, most = 0;
  for (const body& b : made.bodies) widest = std::max(widest, io::printable(b.name).size());
  const auto name = [&](const std::string& n) { return n + std::string(widest - n.size(), ' '); };
  std::cout << name("link") << "  spheres   fill  gap mm: mean   95 %    max   radii mm        holes  seconds\n";
  for (std::size_t k = 0; k < made.bodies.size(); ++k) {
    const packing& p = made.bodies[k].packed;
    std::cout << name(io::printable(made.bodies[k].name))
              << text("  %7zu  %.3f       %6.2f %6.2f %6.2f  %6.2f-%-7.2f  %5u  %7.2f%s\n", p.spheres.size(), p.fill,
                      1e3 * p.gap_mean, 1e3 * p.gap_p95, 1e3 * p.gap, 1e3 * p.radius_min, 1e3 * p.radius_max,
                      made.bodies[k].closed.caps.loops, p.seconds, made.cached[k] ? " (cached)" : "");
    const double n = double(made.bodies.size());
    fill += p.fill / n;
    mean += p.gap_mean / n;
    p95 += p.gap_p95 / n;
    most = std::max(most, p.gap);
    cached += made.cached[k];
    spheres += p.spheres.size();
  }
  std::cout << name("all")
            << text("  %7zu  %.3f       %6.2f %6.2f %6.2f  %24s%7.2f\n", spheres, fill, 1e3 * mean, 1e3 * p95,
                    1e3 * most, "", made.seconds);
  if (cached > 0) std::cout << cached << " of " << made.bodies.size() << " were in the cache\n";
}

int run(const pack_settings& asked) {
  for (const std::string& file : asked.out)
    if (!ends(file, ".glb") && io::spheres_format(file).empty())
      throw usage_error("--out", file + " is none of .ist, .csv, .yaml, .yml and .glb by its name");

  progress shown;
  shown.show("reading " + asked.input);
  io::files_read inputs;
  subject what = io::within_memory(asked.input, [&] { return load(asked); });
  check_kept(chosen_cache(asked.no_cache, asked.cache), !asked.cache.empty(), what.notes);
  for (const std::string& file : asked.out) io::check_output(file, inputs);
  const packed_subject made = fill(what, asked, shown);

  for (const std::string& file : asked.out) {
    shown.show("writing " + file);
    io::check_output(file, inputs);
    write(file, what, made);
  }

  shown.clear();
  say_notes(what.notes);
  say_notes(made.notes);
  if (asked.json) {
    nlohmann::ordered_json out = {{what.robot ? "robot" : "mesh", asked.input}, {"backend", asked.backend}};
    if (what.robot) {
      for (std::size_t k = 0; k < made.bodies.size(); ++k) {
        out["parts"].push_back({{"name", made.bodies[k].name}});
        out["parts"].back().update(quality(made.bodies[k], made.cached[k]));
      }
    } else {
      out.update(quality(made.bodies[0], made.cached[0]));
    }
    std::cout << json_text(out, 2);
  } else if (what.robot) {
    print_all(made);
  } else {
    print_one(made.bodies[0], made.cached[0]);
  }
  return 0;
}

subcommand add_pack(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("pack", "Fill a mesh, or the links of a robot, with inner spheres");
  auto asked = std::make_shared<pack_settings>();
  const auto one = [&](const std::string& name, std::string& to, const std::string& says) {
    return sub->add_option(name, to, says);
  };

  one("INPUT", asked->input, "A mesh (.stl .obj .ply .off .dae .glb) or a robot (.urdf)")->required();
  one("--spheres", asked->spheres, "How many per part; fewer if no more fit")->required();
  sub->add_option(
      "--out", asked->out,
      "Write to this file; may be repeated. .ist: spheres with their certificates; .yaml: as for cuRobo; .csv:\n"
      "x,y,z,r of one part; .glb: a picture with spheres, transparent mesh and a node for each level of the tree");
  one("--gap", asked->gap, "Stop once no point is farther from the spheres than this, m");
  one("--smallest-radius", asked->radius, "Stop where only smaller spheres fit, m");
  one("--seconds", asked->seconds, "Stop after about so many seconds per part");
  one("--seed", asked->seed, "Another of many equally good packings: a whole number");
  sub->add_flag("--allow-overlap", asked->overlap, "Spheres may overlap: fewer do for the same gap");
  sub->add_flag("--no-cache", asked->no_cache, "Pack anew, and keep nothing");
  one("--cache", asked->cache,
      "Keep packings in this folder (default: $CLEARANCE_CACHE, $XDG_CACHE_HOME/clearance, ~/.cache/clearance)");
  one("--backend", asked->backend,
      "host (default) or device: sooner, but other spheres than those that query and run make and keep");
  one("--geometry", asked->geometry, "Of a robot: visual or collision (default)");
  sub->add_flag("--strict", asked->strict, "Refuse of the robot's description what would get a note");
  sub->add_option("--package", asked->packages, package_says);
  sub->add_option("--gltf-up", asked->gltf_up, gltf_up_says);
  sub->add_option("--mesh-limit", asked->mesh_limits, mesh_limit_says());
  sub->add_option("--exclude-link", asked->excluded, "Leave out this link");
  one("--joints", asked->joints, "a,b,...: how the robot stands in the .glb (default: 0, or the nearest limit)");
  sub->add_flag("--json", asked->json, "Print one JSON object");
  return [asked] { return run(*asked); };
}

const listed_subcommand listed_pack(4, add_pack);

}  // namespace
