// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the subcommands share: how words become numbers and poses, and the errors if they do not.

#include <clearance/io/limits.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/io/sentence.hpp>

#include <Eigen/Geometry>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

/// An error sentence about an option; exit code 1.
struct usage_error : std::invalid_argument {
  usage_error(const std::string& option, const std::string& why)
      : std::invalid_argument(clearance::io::sentence_about(option, why)) {}
};

/// The library's error text without its prefix, because the command begins sentences in its own way.
inline std::string without_prefix(std::string why) { return why.starts_with("clearance: ") ? why.substr(11) : why; }

/// The text about them in --help.
inline constexpr const char* exit_codes =
    "Exit codes: 0 done; 1 an error, wrong usage included; 2 --check fails, or points are in the first of --zones; 3 "
    "no valid point.";

/// A subcommand. Calling it reads the options and runs it; it returns the exit code.
using subcommand = std::function<int()>;

/// A program has the subcommands that are linked into it: each registers itself, with its place in --help.
struct listed_subcommand {
  using adds = subcommand (*)(CLI::App& app);
  listed_subcommand(int place, adds add) { all().emplace(place, add); }

  static std::map<int, adds>& all() {
    static std::map<int, adds> listed;
    return listed;
  }
};

/// Numbers between commas, finite unless `infinite` is set; `what` names them, such as "fx,fy,cx,cy".
std::vector<double> numbers(const std::string& option, const std::string& text, bool infinite = false);
std::vector<double> numbers(const std::string& option, const std::string& text, std::size_t count,
                            const std::string& what, bool infinite = false);
double number(const std::string& option, const std::string& text);

/// A whole number from 1 to `most`.
std::size_t whole_number(const std::string& option, const std::string& text, std::size_t most = 10'000'000);

/// x,y,z,qx,qy,qz,qw. A quaternion within 1e-3 of unit length is normalised, any other refused.
Eigen::Isometry3d pose(const std::string& option, const std::string& text);
Eigen::Isometry3d pose(const std::string& option, const Eigen::Vector3d& translation, Eigen::Quaterniond rotation);

/// The index of the text in `names`.
std::size_t choice(const std::string& option, const std::string& text, const std::vector<std::string>& names);

/// The mesh limits of --mesh-limit, name=number each; the names are those in refusals.
clearance::io::mesh_limits limits_of(const std::vector<std::string>& given);
std::string mesh_limit_says();
inline constexpr const char* geometry_says = "visual or collision (default; visual where a link has no collision)";
inline constexpr const char* package_says =
    "name=DIR: where package://name/ is, and what follows name/ in an absolute path that is not on this machine";

/// The folders of --package by their names, each given once.
std::map<std::string, std::filesystem::path> packages_of(const std::vector<std::string>& given);

/// The axis of --gltf-up, none if it is not given; and its help.
std::optional<clearance::io::gltf_axis> gltf_axis_of(const std::string& given);
inline constexpr const char* gltf_up_says =
    "y or z: which axis of glTF meshes (.glb, .gltf) is up (default: as a link's other geometry shows, else y, as the "
    "format has it; a note says which)";

/// Splits a text into two words at the first '='; a refusal shows the expected form.
std::pair<std::string, std::string> assignment(const std::string& option, const std::string& text,
                                               const char* form = "name=value");

/// Is it --backend device? Throws if no device is there.
bool is_device(const std::string& backend);
