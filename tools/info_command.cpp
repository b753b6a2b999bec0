// SPDX-License-Identifier: BSD-3-Clause
#include "backends.hpp"
#include "command_line.hpp"
#include "json_text.hpp"
#include "messages.hpp"
#include "noted_files.hpp"
#include "report_text.hpp"
#include "robot_bodies.hpp"

#include <clearance/ground/config.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/io/robot.hpp>

#include <tbb/global_control.h>
#include <CLI/CLI.hpp>
#include <Eigen/Core>

#include <iostream>

using json = nlohmann::ordered_json;

namespace {

/// Describes a file of spheres. Exit code 0: the file is complete.
int describe(const std::string& file, bool as_json) {
  std::vector<std::string> notes;
  const auto parts = clearance::io::within_memory(file, [&] { return noted_spheres(file, {}, notes); });
  say_notes(notes);

  json out = {{"file", file}, {"parts", json::array()}};
  std::string text = clearance::io::printable(file) + ": " + std::to_string(parts.size()) +
                     (parts.size() == 1 ? " part\n" : " parts\n");
  for (const auto& part : parts) {
    const clearance::packing& p = part.spheres;
    const bool certified = std::isfinite(p.gap);
    out["parts"].push_back({{"name", part.name},
                            {"spheres", p.spheres.size()},
                            {"radius_min", p.radius_min},
                            {"radius_max", p.radius_max},
                            {"certified", certified},
                            {"gap", or_null(p.gap)},
                            {"gap_mean", or_null(p.gap_mean)},
                            {"gap_p95", or_null(p.gap_p95)},
                            {"fill", certified ? json(p.fill) : json(nullptr)},
                            {"tolerance", part.tolerance},
                            {"seconds", certified ? json(p.seconds) : json(nullptr)},
                            {"solid", part.solid ? json(part.solid.hex()) : json(nullptr)}});

    char line[256];
    std::snprintf(line, sizeof line, "%zu spheres, radii %.6f to %.6f m, ", p.spheres.size(), p.radius_min,
                  p.radius_max);
    text += name_column(part.name) + line;
    if (certified)
      std::snprintf(line, sizeof line, "gap at most %.6f m (95 %% %.6f, mean %.6f), fill %.4f", p.gap, p.gap_p95,
                    p.gap_mean, p.fill);
    text += certified ? line : "no certificate";
    if (part.solid) text += ", of mesh " + part.solid.hex().substr(0, 12);
    text += '\n';
  }

  std::cout << (as_json ? json_text(out, 2) : text);
  return 0;
}

/// Says how the inside of each part of a robot, or of a mesh, is known. Exit code 0: all of its files are complete.
int describe_solids(const std::string& file, const std::vector<std::string>& packages,
                    std::optional<clearance::io::gltf_axis> up, bool visual, bool as_json) {
  std::vector<clearance::io::robot_part> parts;
  std::vector<std::string> notes;
  if (file.ends_with(".urdf")) {
    clearance::io::robot_options options;
    options.packages = packages_of(packages);
    options.gltf_up = up;
    if (visual) options.geometry = clearance::io::robot_geometry::visual;
    const auto robot = clearance::io::load_robot(file, options);
    parts = robot.parts();
    notes = robot.notes();
  } else {
    parts.push_back({.name = std::filesystem::path(file).stem().string(), .mesh = noted_mesh(file, {}, up, notes)});
  }

  std::vector<body_source> sources;
  for (const auto& part : parts) sources.push_back({part.name, &part.mesh, part.tessellation_error});
  progress shown;
  body_account account;
  const std::vector<body> bodies = make_bodies(sources, {.spheres = false}, shown, account);
  shown.clear();
  notes.insert(notes.end(), account.notes.begin(), account.notes.end());
  say_notes(notes);

  json out = {{"file", file}, {"parts", json::array()}};
  std::string text = clearance::io::printable(file) + ": " + std::to_string(bodies.size()) +
                     (bodies.size() == 1 ? " part\n" : " parts\n");
  for (const body& b : bodies) {
    const double tolerance = b.tolerance + b.closed.tolerance;
    out["parts"].push_back({{"name", b.name},
                            {"triangles", b.closed.loaded},
                            {"bodies", b.closed.encloses.size()},
                            {"inside", to_string(b.closed.inside)},
                            {"tolerance", tolerance},
                            {"caps", {{"loops", b.closed.caps.loops}, {"area", b.closed.caps.area}}}});
    char line[256];
    std::snprintf(line, sizeof line, "%u triangles, inside by %s, %u holes closed, to within %.6f m\n", b.closed.loaded,
                  to_string(b.closed.inside), b.closed.caps.loops, tolerance);
    text += name_column(b.name) + line;
  }

  std::cout << (as_json ? json_text(out, 2) : text);
  return 0;
}

subcommand add_info(CLI::App& app) {
  CLI::App* sub = app.add_subcommand(
      "info",
      "What this clearance was built with and runs on; what is in a file of spheres; or how it is known what a "
      "robot's parts, or a mesh, enclose");
  struct settings {
    std::string file;
    std::string gltf_up, geometry;
    std::vector<std::string> packages;
    bool json = false;
  };

  auto asked = std::make_shared<settings>();
  sub->add_option("FILE", asked->file, "Spheres (.ist, .yaml or .csv), a robot (.urdf) or a mesh");
  sub->add_option("--geometry", asked->geometry, geometry_says);
  sub->add_option("--package", asked->packages, package_says);
  sub->add_option("--gltf-up", asked->gltf_up, gltf_up_says);
  sub->add_flag("--json", asked->json, "Print one JSON object");

  return [asked] {
    const bool spheres = !clearance::io::spheres_format(asked->file).empty();
    if (!asked->file.empty() && !asked->file.ends_with(".urdf"))
      for (const auto& [option, given] :
           {std::pair{"--geometry", !asked->geometry.empty()}, {"--package", !asked->packages.empty()}})
        if (given) throw usage_error(option, "is for robots, and " + asked->file + " is none by its name");
    const bool visual = !asked->geometry.empty() && choice("--geometry", asked->geometry, {"collision", "visual"}) == 1;
    if (spheres && !asked->gltf_up.empty())
      throw usage_error("--gltf-up", "is for meshes, and " + asked->file + " holds spheres");
    if (spheres) return describe(asked->file, asked->json);
    if (!asked->file.empty())
      return clearance::io::within_memory(asked->file, [&] {
        return describe_solids(asked->file, asked->packages, gltf_axis_of(asked->gltf_up), visual, asked->json);
      });

    const std::string version = std::to_string(CLEARANCE_VERSION_MAJOR) + '.' +
                                std::to_string(CLEARANCE_VERSION_MINOR) + '.' + std::to_string(CLEARANCE_VERSION_PATCH);
    const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const device_state gpu = find_device();
    const std::string cache = clearance::io::packing_cache::usual_folder().string();
    if (asked->json) {
      const json out = {{"version", version},
                        {"compiler", __VERSION__},
                        {"threads", threads},
                        {"cuda", gpu.compiled},
                        {"device", gpu.present ? json(gpu.says) : nullptr},
                        {"backend", gpu.present ? "device" : "host"},
                        {"cache", cache.empty() ? json(nullptr) : json(cache)}};
      std::cout << json_text(out, 2);
      return 0;
    }
    std::cout << "clearance " << version << ", compiled by " << __VERSION__ << '\n'
              << "host    " << threads << " threads\n"
              << "device  " << (gpu.present ? gpu.says : "none: " + gpu.says) << '\n'
              << "reads   robots: URDF; meshes: STL, OBJ, PLY, OFF, DAE, GLB, GLTF; clouds: PCD, PLY, XYZ; depth: "
                 "16-bit PNG\n"
              << "writes  scenes: GLB\n"
              << "both    spheres: IST, YAML, CSV; kept in " << (cache.empty() ? "no cache" : cache) << '\n';
    return 0;
  };
}

const listed_subcommand listed_info(6, add_info);

}  // namespace
