// SPDX-License-Identifier: BSD-3-Clause
// Asks the same question with both models and every volume on every backend. Prints the answers, which must agree.
#include "backends.hpp"
#include "command_line.hpp"
#include "demo_scene.hpp"
#include "kept_packings.hpp"
#include "messages.hpp"
#include "robot_bodies.hpp"
#include "stopwatch.hpp"

#include <clearance/io/scene.hpp>
#include <clearance/io/write_file.hpp>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>

using namespace clearance;

namespace {

struct demo_settings {
  std::string spheres = "2048", scene, cache;
  bool no_cache = false;
};

struct demo_row {
  bool on_device;
  asked_model asked;
  reply found;
  double query;  // seconds
};

depth_image<std::uint16_t> image_of(const demo_scene& world) {
  return {world.depth.data(), world.width, world.height, world.camera};
}

void draw(const demo_scene& world, const demo_row& row, const std::string& file) {
  io::scene scene;
  const min_distance_result& r = row.found.result;
  for (std::size_t k = 0; k < world.parts.size(); ++k) {
    scene.bodies.push_back({.name = world.parts[k].name, .mesh = world.parts[k].mesh, .pose = world.parts[k].pose});
    if (r.part == k) scene.bodies.back().paint = {0.95f, 0.6f, 0.2f, 1};
  }
  std::vector<vec3> points;
  const auto image = image_of(world);
  for (std::size_t i = 0; i < image.size(); ++i)
    if (const sample s = image[i]; s.valid()) points.push_back(s.position);
  scene.clouds.push_back({.name = "depth", .points = std::move(points), .pose = world.world_from_camera});
  scene.segments.push_back(
      {.name = "witness", .from = {r.nearest.x, r.nearest.y, r.nearest.z}, .to = {r.at.x, r.at.y, r.at.z}});
  io::save_scene(scene, file);
}

void print(const demo_row& row, const std::vector<body>& bodies) {
  const min_distance_result& r = row.found.result;
  const std::string part = r.part == none ? "-" : bodies[r.part].name;
  const std::string pixel = std::to_string(r.point % 640) + ',' + std::to_string(r.point / 640);
  std::printf("%-8s %-10s %-7s %10.6f  %.6f to %.6f  %-8s %-12s %9u  %10.3f\n", row.on_device ? "device" : "host",
              to_string(row.asked.model), to_string(row.asked.volume), double(r.distance), double(r.lower),
              double(r.upper), pixel.c_str(), part.c_str(), r.primitive, 1e3 * row.query);
}

bool same_witness(const min_distance_result& a, const min_distance_result& b) {
  return a.distance == b.distance && a.point == b.point && a.part == b.part && a.primitive == b.primitive;
}

/// The arm's bodies with both models; prints what it is, and how long it took to make.
std::vector<body> make_arm(const demo_scene& world, const demo_settings& settings, std::size_t count,
                           stopwatch& clock) {
  progress shown;
  std::vector<body_source> sources;
  std::size_t triangles = 0;
  for (const auto& part : world.parts) {
    sources.push_back({part.name, &part.mesh});
    triangles += part.mesh.triangles.size();
  }
  body_account account;
  const body_options how{.pack = {.count = count}, .cache = chosen_cache(settings.no_cache, settings.cache)};
  std::vector<std::string> notes;
  check_kept(how.cache, !settings.cache.empty(), notes);
  std::vector<body> bodies = make_bodies(sources, how, shown, account);
  shown.clear();
  say_notes(notes);
  const double seconds = clock.lap();

  std::size_t spheres = 0;
  double gap = 0;
  for (const body& b : bodies) {
    spheres += b.packed.spheres.size();
    gap = std::max(gap, b.packed.gap);
  }
  std::printf("An arm of %zu parts: %zu triangles, %zu inner spheres (gap at most %.2f mm), made in %.1f s%s.\n",
              bodies.size(), triangles, spheres, 1e3 * gap, seconds,
              account.packed == 0 ? " from those that were kept" : "");
  return bodies;
}

/// Asks with every model and volume, on the host and on a device if there is one; prints a row for each.
std::vector<demo_row> ask_every_way(const demo_scene& world, const std::vector<body>& bodies, bool has_device) {
  std::printf("%-8s %-10s %-7s %10s  %-20s  %-8s %-12s %9s  %10s\n", "backend", "model", "volume", "distance m",
              "certainly m", "pixel", "part", "primitive", "time ms");
  std::vector<Eigen::Isometry3d> poses;
  for (const auto& part : world.parts) poses.push_back(part.pose);
  std::vector<demo_row> rows;
  for (const bool on_device : {false, true}) {
    if (on_device && !has_device) continue;
    for (const auto model : {model_kind::spheres, model_kind::triangles})
      for (const auto volume : {volume_kind::sphere, volume_kind::aabb, volume_kind::obb}) {
        const asked_model asked{model, volume, &bodies};
        const auto arm = robot_on(on_device, asked);
        arm->see({seen_points{image_of(world), world.world_from_camera}});
        const reply found = arm->least_per_part(poses, 5);
        rows.push_back({on_device, asked, found, arm->query});
        print(rows.back(), bodies);
      }
  }
  return rows;
}

/// Do all rows say the same of a model, and is there a distance that all brackets hold? Prints both.
bool agree(const std::vector<demo_row>& rows) {
  bool same = true;
  double lower = 0, upper = infinity;
  for (const demo_row& row : rows) {
    lower = std::max(lower, double(row.found.result.lower));
    upper = std::min(upper, double(row.found.result.upper));
    for (const demo_row& other : rows)
      if (other.asked.model == row.asked.model && !same_witness(other.found.result, row.found.result)) same = false;
  }
  const bool meet = lower <= upper && rows.front().found.result.state != state::no_data;
  std::printf("Witnesses within a model %s. Brackets %s.\n", same ? "are the same" : "DIFFER",
              meet ? "meet" : "DO NOT MEET");
  return same && meet;
}

int run(const demo_settings& settings) {
  const std::size_t count = whole_number("--spheres", settings.spheres);
  const device_state gpu = find_device();
  if (!settings.scene.empty()) io::check_target(settings.scene);
  stopwatch clock;
  const demo_scene world = make_demo_scene();
  const std::vector<body> bodies = make_arm(world, settings, count, clock);
  std::printf("A depth frame of %ux%u pixels from the camera on its hand. Device: %s.\n\n", world.width, world.height,
              gpu.says.c_str());
  const std::vector<demo_row> rows = ask_every_way(world, bodies, gpu.present);
  const min_distance_result& first = rows.front().found.result;
  std::printf("\n%llu pixels seen, %llu valid. State: %s.\n", (unsigned long long)first.seen,
              (unsigned long long)first.valid, to_string(first.state));
  const bool good = agree(rows);
  if (!settings.scene.empty()) draw(world, rows.front(), settings.scene);
  std::fflush(stdout);
  return good ? 0 : 1;
}

subcommand add_demo(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("demo", "A made-up arm before a made-up table; needs no file");
  auto settings = std::make_shared<demo_settings>();
  sub->add_option("--spheres", settings->spheres, "Inner spheres per part (default 2048)");
  sub->add_flag("--no-cache", settings->no_cache, "Pack anew, and keep nothing");
  sub->add_option("--cache", settings->cache, "Keep packings in this folder");
  sub->add_option("--scene", settings->scene, "Write arm, points and witness to this .glb file");
  return [settings] { return run(*settings); };
}

const listed_subcommand listed_demo(5, add_demo);

}  // namespace
