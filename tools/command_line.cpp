// SPDX-License-Identifier: BSD-3-Clause
#include "command_line.hpp"

#include "backends.hpp"

#include <clearance/io/cloud_text.hpp>

#include <cmath>
#include <cstdint>

std::vector<double> numbers(const std::string& option, const std::string& text, bool infinite) {
  std::vector<double> values;
  std::string_view rest = text;
  for (;;) {
    const std::size_t comma = rest.find(',');
    std::string_view word = rest.substr(0, comma);
    while (word.starts_with(' ')) word.remove_prefix(1);
    while (word.ends_with(' ')) word.remove_suffix(1);
    const auto value = clearance::io::number<double>(word);
    if (!value || std::isnan(*value) || (!infinite && !std::isfinite(*value)))
      throw usage_error(option, clearance::io::quoted(word) + " is not a" + (value ? " finite" : "") + " number");
    values.push_back(*value);
    if (comma == rest.npos) return values;
    rest.remove_prefix(comma + 1);
  }
}

std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count,
                            const std::string& what, bool infinite) {
  auto values = numbers(option, text, infinite);
  if (values.size() != count)
    throw usage_error(
        option, "needs " + std::to_string(count) + " numbers, " + what + "; here are " + std::to_string(values.size()));
  return values;
}

double number(const std::string& option, const std::string& text) { return numbers(option, text, 1, "one")[0]; }

std::size_t whole_number(const std::string& option, const std::string& text, std::size_t most) {
  const auto value = clearance::io::number<std::uint64_t>(text);
  if (!value || *value < 1 || *value > most)
    throw usage_error(option, clearance::io::quoted(text) + " is not a whole number from 1 to " + std::to_string(most));
  return *value;
}

Eigen::Isometry3d pose(const std::string& option, const std::string& text) {
  const auto v = numbers(option, text, 7, "x,y,z,qx,qy,qz,qw");
  return pose(option, {v[0], v[1], v[2]}, Eigen::Quaterniond(v[6], v[3], v[4], v[5]));
}

Eigen::Isometry3d pose(const std::string& option, const Eigen::Vector3d& translation, Eigen::Quaterniond rotation) {
  const double length = rotation.norm();
  if (!(std::abs(length - 1) <= 1e-3))
    throw usage_error(option, "the quaternion has length " + std::to_string(length) +
                                  ", not 1, so the pose is not rigid (the order is qx,qy,qz,qw)");
  Eigen::Isometry3d made = Eigen::Isometry3d::Identity();
  made.linear() = rotation.normalized().toRotationMatrix();
  made.translation() = translation;
  return made;
}

std::size_t choice(const std::string& option, const std::string& text, const std::vector<std::string>& names) {
  std::string known;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (text == names[i]) return i;
    known += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  }
  throw usage_error(option, clearance::io::quoted(text) + " is not " + known);
}

namespace {

struct named_limit {
  const char* name;
  std::uint64_t clearance::io::mesh_limits::* value;
};
constexpr named_limit mesh_limit_names[] = {{"bytes", &clearance::io::mesh_limits::bytes},
                                            {"triangles", &clearance::io::mesh_limits::triangles},
                                            {"values", &clearance::io::mesh_limits::values},
                                            {"nodes", &clearance::io::mesh_limits::nodes},
                                            {"depth", &clearance::io::mesh_limits::depth}};

}  // namespace

std::string mesh_limit_says() {
  const clearance::io::mesh_limits usual;
  std::string names;
  for (const auto& [name, value] : mesh_limit_names)
    names += (names.empty() ? "" : ", ") + std::string(name) + "=" + std::to_string(usual.*value);
  return "name=number: a limit of one mesh, or of a robot with all its meshes, by the name that a refusal gives it; "
         "may be repeated (default " +
         names + ")";
}

clearance::io::mesh_limits limits_of(const std::vector<std::string>& given) {
  clearance::io::mesh_limits made;
  std::vector<std::string> names;
  for (const auto& each : mesh_limit_names) names.push_back(each.name);
  std::vector<bool> seen(names.size());
  for (const std::string& text : given) {
    const auto [name, word] = assignment("--mesh-limit", text);
    const std::size_t which = choice("--mesh-limit", name, names);
    if (seen[which]) throw usage_error("--mesh-limit", name + " is given twice");
    seen[which] = true;
    const auto value = clearance::io::number<std::uint64_t>(word);
    const std::uint64_t most = name == "depth" ? 1000 : std::uint64_t(1) << 40;  // readers recurse this deeply
    if (!value || *value < 1 || *value > most)
      throw usage_error("--mesh-limit",
                        clearance::io::quoted(text) + " needs a whole number from 1 to " + std::to_string(most));
    made.*mesh_limit_names[which].value = *value;
  }
  return made;
}

std::map<std::string, std::filesystem::path> packages_of(const std::vector<std::string>& given) {
  std::map<std::string, std::filesystem::path> folders;
  for (const std::string& text : given) {
    const auto [name, folder] = assignment("--package", text, "name=DIR");
    if (!folders.emplace(name, folder).second) throw usage_error("--package", name + " is given twice");
  }
  return folders;
}

std::optional<clearance::io::gltf_axis> gltf_axis_of(const std::string& given) {
  if (given.empty()) return std::nullopt;
  return clearance::io::gltf_axis(choice("--gltf-up", given, {"y", "z"}));
}

std::pair<std::string, std::string> assignment(const std::string& option, const std::string& text, const char* form) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos || equals == 0 || equals + 1 == text.size())
    throw usage_error(option, clearance::io::quoted(text) + " is not of the form " + form);
  return {text.substr(0, equals), text.substr(equals + 1)};
}

bool is_device(const std::string& backend) {
  if (choice("--backend", backend, {"host", "device"}) == 0) return false;
  if (const device_state gpu = find_device(); !gpu.present)
    throw usage_error("--backend", "device is not possible: " + gpu.says);
  return true;
}
