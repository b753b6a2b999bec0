// SPDX-License-Identifier: BSD-3-Clause
#include "backends.hpp"
#include "command_line.hpp"
#include "json_text.hpp"

#include <clearance/ground/config.hpp>
#include <clearance/io/packing_cache.hpp>
#include <clearance/io/spheres_file.hpp>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <tbb/global_control.h>

#include <iostream>

using json = nlohmann::ordered_json;

namespace {

json or_null(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

/// What a file of spheres holds. Exit code 0: it is whole.
int describe(const std::string& file, bool as_json) {
  const auto parts = clearance::io::within_memory(file, [&] { return clearance::io::load_spheres(file); });
  json out = {{"file", file}, {"parts", json::array()}};
  std::string text = clearance::io::printable(file) + ": " + std::to_string(parts.size()) + (parts.size() == 1 ? " part\n" : " parts\n");
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
    std::snprintf(line, sizeof line, "%zu spheres, radii %.6f to %.6f m, ", p.spheres.size(), p.radius_min, p.radius_max);
    const std::string name = clearance::io::printable(part.name);
    text += "  " + name + std::string(name.size() < 28 ? 28 - name.size() : 1, ' ') + line;
    if (certified)
      std::snprintf(line, sizeof line, "gap at most %.6f m (95 %% %.6f, mean %.6f), fill %.4f", p.gap, p.gap_p95, p.gap_mean, p.fill);
    text += certified ? line : "no certificate";
    if (part.solid) text += ", of mesh " + part.solid.hex().substr(0, 12);
    text += '\n';
  }
  std::cout << (as_json ? json_text(out, 2) : text);
  return 0;
}

}  // namespace

subcommand add_info(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("info", "What this clearance was built with and runs on; or what is in a file of spheres");
  struct settings {
    std::string file;
    bool json = false;
  };
  auto asked = std::make_shared<settings>();
  sub->add_option("FILE", asked->file, "Spheres: .ist, .yaml or .csv");
  sub->add_flag("--json", asked->json, "Print one JSON object");
  return [asked] {
    if (!asked->file.empty()) return describe(asked->file, asked->json);
    const std::string version = std::to_string(CLEARANCE_VERSION_MAJOR) + '.' + std::to_string(CLEARANCE_VERSION_MINOR) + '.' +
                                std::to_string(CLEARANCE_VERSION_PATCH);
    const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const device_state gpu = find_device();
    const std::string cache = clearance::io::packing_cache::usual_folder().string();
    if (asked->json) {
      const json out = {{"version", version}, {"compiler", __VERSION__}, {"threads", threads},
                                          {"cuda", gpu.compiled}, {"device", gpu.present ? json(gpu.says) : nullptr},
                                          {"backend", gpu.present ? "device" : "host"},
                        {"cache", cache.empty() ? json(nullptr) : json(cache)}};
      std::cout << json_text(out, 2);
      return 0;
    }
    std::cout << "clearance " << version << ", compiled by " << __VERSION__ << '\n'
              << "host    " << threads << " threads\n"
              << "device  " << (gpu.present ? gpu.says : "none: " + gpu.says) << '\n'
              << "reads   robots: URDF; meshes: STL, OBJ, PLY, OFF, DAE, GLB; clouds: PCD, PLY, XYZ; depth: 16-bit PNG\n"
              << "writes  scenes: GLB\n"
              << "both    spheres: IST, YAML, CSV; kept in " << (cache.empty() ? "no cache" : cache) << '\n';
    return 0;
  };
}
