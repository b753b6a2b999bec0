// SPDX-License-Identifier: BSD-3-Clause
#include "cloud_options.hpp"

#include "command_line.hpp"

#include <clearance/io/cloud_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <map>
#include <string_view>

bool cloud_options::is_image() const { return clearance::io::extension(file) == ".png"; }

void cloud_options::check(const std::string& option) const {
  if (is_image() && !camera)
    throw usage_error(option, file + " is a depth image, which needs --intrinsics fx,fy,cx,cy");
}

void cloud_options::check_hides() const {
  if (!is_image())
    throw usage_error("--unseen",
                      file + " is a point cloud, which does not say what was hidden; it needs a depth image");
}

namespace {

constexpr std::string_view for_images[] = {"--intrinsics", "--depth-scale"},
                           for_clouds[] = {"--cloud-scale", "--use-viewpoint", "--zero-is-missing"},
                           of_one_cloud[] = {"--camera-pose",   "--camera-link",    "--intrinsics", "--depth-scale",
                                             "--cloud-scale",   "--range",          "--sensor",     "--calibration",
                                             "--use-viewpoint", "--zero-is-missing"};

}  // namespace

void check_all_clouds(const cloud_options& all, const std::vector<cloud_options>& clouds) {
  const auto images = std::size_t(std::ranges::count_if(clouds, &cloud_options::is_image));
  for (const std::string& option : all.given) {
    if (images == 0 && std::ranges::count(for_images, option))
      throw usage_error(option, "is for depth images, and there is none");
    if (images == clouds.size() && std::ranges::count(for_clouds, option))
      throw usage_error(option, "is for point clouds, and there is none");
  }
}

namespace {

/// The noise that an option names: kinect, stereo:F,B,S, tof:C,S or lidar:C,S.
clearance::any_noise sensor_of(const std::string& option, const std::string& text) {
  using clearance::real;
  const std::size_t at = text.find(':');
  const std::string kind = text.substr(0, at), rest = at == text.npos ? std::string() : text.substr(at + 1);
  clearance::any_noise sensor;
  const auto of = [&](std::size_t count, const char* what) { return numbers(option, rest, count, kind + ':' + what); };

  if (kind == "stereo") {
    const auto v = of(3, "F,B,S (focal length in pixels, baseline in m, deviation of a disparity in pixels)");
    sensor.kind = clearance::noise_kind::stereo;
    sensor.stereo = {real(v[0]), real(v[1]), real(v[2])};
  } else if (kind == "tof") {
    const auto v = of(2, "C,S (m, and m for each square metre)");
    sensor.kind = clearance::noise_kind::tof;
    sensor.tof = {real(v[0]), real(v[1])};
  } else if (kind == "lidar") {
    const auto v = of(2, "C,S (m, and m for each metre)");
    sensor.kind = clearance::noise_kind::lidar;
    sensor.lidar = {real(v[0]), real(v[1])};
  } else if (text == "kinect") {
    sensor.kind = clearance::noise_kind::kinect;
  } else {
    throw usage_error(option, clearance::io::quoted(text) + " is none of kinect, stereo:F,B,S, tof:C,S and lidar:C,S");
  }

  try {
    sensor.check(0);
  } catch (const std::invalid_argument& error) {
    throw usage_error(option, without_prefix(error.what()));
  }
  return sensor;
}
/// Sets one per-cloud option, given on the command line.
void set(cloud_options& cloud, const std::string& option, const std::string& text) {
  if (option == "--camera-pose") cloud.pose = pose(option, text);
  if (option == "--camera-link") cloud.link = text;
  if (option == "--intrinsics") {
    const auto v = numbers(option, text, 4, "fx,fy,cx,cy");
    if (!(v[0] > 0 && v[1] > 0)) throw usage_error(option, "the focal lengths fx and fy must be above 0 (pixels)");
    cloud.camera = clearance::intrinsics{v[0], v[1], v[2], v[3]};
    cloud.shares_camera = cloud.file.empty();
  }
  if (option == "--depth-scale") {
    cloud.scale = number(option, text);
    if (!(cloud.scale > 0)) throw usage_error(option, "must be above 0 (metres per unit)");
  }
  if (option == "--cloud-scale") {
    cloud.cloud_scale = number(option, text);
    if (!(cloud.cloud_scale >= 1e-9 && cloud.cloud_scale <= 1e9))
      throw usage_error(option, "must be from 1e-9 to 1e9 (metres per unit)");
  }
  if (option == "--range") {
    const auto v = numbers(option, text, 2, "near,far", true);
    if (!(v[0] >= 0 && v[0] < v[1])) throw usage_error(option, "needs 0 <= near < far (metres)");
    cloud.nearest = v[0];
    cloud.farthest = v[1];
  }
  if (option == "--sensor") cloud.sensor = sensor_of(option, text);
  if (option == "--calibration") {
    const auto v = numbers(option, text, 2, "DT,DTHETA");
    if (!(v[0] >= 0 && v[0] <= 1e15 && v[1] >= 0 && v[1] <= 1e15))
      throw usage_error(option, "needs 0 or more (metres, and radians)");
    cloud.off.shift = v[0];
    cloud.off.turn = v[1];
  }
  if (option == "--use-viewpoint") cloud.use_viewpoint = true;
  if (option == "--zero-is-missing") cloud.zero_is_missing = true;

  if (cloud.file.empty()) cloud.given.push_back(option);
  if (!cloud.file.empty() && !cloud.is_image() && std::ranges::count(for_images, option))
    throw usage_error(option, "is for depth images, and " + cloud.file + " is none");
  if (!cloud.file.empty() && cloud.is_image() && std::ranges::count(for_clouds, option))
    throw usage_error(option, "is for point clouds, and " + cloud.file + " is a depth image");
}

}  // namespace

std::vector<std::pair<std::string, std::string>> in_order(const CLI::App& app) {
  std::vector<std::pair<std::string, std::string>> given;
  std::map<const CLI::Option*, std::size_t> taken;
  for (const CLI::Option* option : app.parse_order())
    given.emplace_back(option->get_name(), option->results().at(taken[option]++));
  return given;
}

void check_given_once(const CLI::App& app) {
  const bool many = app.get_option_no_throw("--cloud") != nullptr;
  std::string cloud;
  std::vector<std::string> given;
  for (const auto& [name, text] : in_order(app)) {
    if (name == "--cloud") {
      cloud = text;
      given.clear();
    }
    if (!std::ranges::count(of_one_cloud, name)) continue;
    if (std::ranges::count(given, name))
      throw usage_error(name, !many           ? "is given twice, and holds for all frames"
                              : cloud.empty() ? "is given twice before the first --cloud, where it holds for all"
                                              : "is given twice for " + cloud +
                                                    ": it is for the --cloud before it, or before the first for all");
    given.push_back(name);
  }
}

std::vector<cloud_options> clouds_of(const CLI::App& app, cloud_options& all) {
  std::vector<cloud_options> clouds;
  for (const auto& [name, text] : in_order(app)) {
    if (name == "--cloud") {
      clouds.push_back(all);
      clouds.back().file = text;
    } else {
      set(clouds.empty() ? all : clouds.back(), name, text);
    }
  }
  for (const auto& cloud : clouds) cloud.check("--cloud");
  if (!clouds.empty()) check_all_clouds(all, clouds);
  return clouds;
}
