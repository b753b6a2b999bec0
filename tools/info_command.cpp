// SPDX-License-Identifier: BSD-3-Clause
#include "backends.hpp"
#include "command_line.hpp"

#include <clearance/config.hpp>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <tbb/global_control.h>

#include <iostream>

subcommand add_info(CLI::App& app) {
  CLI::App* sub = app.add_subcommand("info", "What this clearance was built with and what it runs on");
  auto json = std::make_shared<bool>(false);
  sub->add_flag("--json", *json, "Print one JSON object");
  return [json] {
    const std::string version = std::to_string(CLEARANCE_VERSION_MAJOR) + '.' + std::to_string(CLEARANCE_VERSION_MINOR) + '.' +
                                std::to_string(CLEARANCE_VERSION_PATCH);
    const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    const device_state gpu = find_device();
    if (*json) {
      const nlohmann::ordered_json out = {{"version", version}, {"compiler", __VERSION__}, {"threads", threads},
                                          {"cuda", gpu.compiled}, {"device", gpu.present ? nlohmann::ordered_json(gpu.says) : nullptr},
                                          {"backend", gpu.present ? "device" : "host"}};
      std::cout << out.dump(2) << '\n';
      return 0;
    }
    std::cout << "clearance " << version << ", compiled by " << __VERSION__ << '\n'
              << "host    " << threads << " threads\n"
              << "device  " << (gpu.present ? gpu.says : "none: " + gpu.says) << '\n'
              << "reads   robots: URDF; meshes: STL, OBJ, PLY, OFF, DAE, GLB; clouds: PCD, PLY, XYZ; depth: 16-bit PNG\n"
              << "writes  scenes: GLB; spheres: CSV\n";
    return 0;
  };
}
