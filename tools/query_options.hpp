// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "backends.hpp"

#include <clearance/frames/cropped_clouds.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/limits.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/points/hidden.hpp>

#include <Eigen/Geometry>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

/// One --cloud with its options.
struct cloud_options {
  std::string file;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // world-from-cloud, or link-from-cloud
  std::string link;                                        // empty: the world
  std::optional<clearance::intrinsics> camera;
  bool shares_camera = false;  // given before the first --cloud, for all images
  double scale = 0.001;        // --depth-scale
  double cloud_scale = 1;      // --cloud-scale
  double nearest = 0, farthest = clearance::infinity;
  bool use_viewpoint = false, zero_is_missing = false;
  clearance::any_noise sensor = {};       // --sensor
  clearance::cloud_uncertainty off = {};  // --calibration, --delay, --max-speed
  double later = 0;                       // --plan-time, of the plan of `clearance run`; seconds
  clearance::io::read_limits limits;
  std::uint64_t bytes_each = 0;    // made per point, in memory or in an output file; the limit counts these
  std::vector<std::string> given;  // the options before the first --cloud, by name: for all clouds

  bool is_image() const;

  /// Throws usage_error about `option` if something is missing.
  void check(const std::string& option) const;
  /// Throws usage_error unless it is an image, for --unseen.
  void check_hides() const;
};

/// Throws usage_error if an option in `all` fits the kind of none of `clouds`.
void check_all_clouds(const cloud_options& all, const std::vector<cloud_options>& clouds);

/// One --attach: an object that a link holds.
struct attachment_options {
  std::string link, file;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  // link-from-thing
};

/// --min-support N@RADIUS.
struct support_asked {
  std::uint32_t min_points;
  double radius;            // metres
  std::size_t most = 4096;  // --support-limit
};

/// What is uncertain about the joints: one number for all, or one each in the file's order (rad, m); empty: 0.
struct joints_off {
  std::vector<double> errors, speeds;  // --joint-error, --joint-speed
  double delay = 0;                    // --delay, seconds
};

/// The recording that `clearance run` plays.
struct recording_options {
  std::string frames, trajectory;
  cloud_options camera;  // holds for every frame; .file is empty
  std::string stamps;    // --stamps: a file of the frames' times; empty: the trajectory has a row for each frame
  double max_age = 0.1;  // --max-age: seconds; no joints that are farther in time from a frame are used
  bool merge = false;
  std::string plan;  // future configurations, asked about in every frame; empty: none
  std::string svg;   // a picture of all frames; empty: none
};

struct query_options {
  std::string robot;
  std::vector<double> joints;                         // in the file's order; empty: not given
  std::vector<std::pair<std::string, double>> joint;  // by name
  bool ignore_limits = false, strict = false;
  std::optional<bool> visual;  // --geometry
  std::map<std::string, std::filesystem::path> packages;
  std::optional<clearance::io::gltf_axis> gltf_up;  // --gltf-up
  clearance::io::mesh_limits limits;
  Eigen::Isometry3d base = Eigen::Isometry3d::Identity();
  std::vector<cloud_options> clouds;
  model_kind model = model_kind::spheres;
  volume_kind volume = volume_kind::sphere;
  std::optional<std::size_t> spheres;
  std::string packing;  // --packing: a file of spheres
  bool no_cache = false;
  std::string cache;
  std::vector<std::string> excluded;
  std::vector<attachment_options> attached;
  bool on_device = false;
  std::optional<double> margin;
  bool json = false;
  std::string scene;
  std::vector<double> zones;   // --zones: thresholds in metres, ascending; empty: not asked
  std::size_t min_points = 1;  // for a zone to count
  std::string distances;       // --distances: a file; empty: not asked
  bool is_signed = false;      // --signed, for --distances
  bool cells = false;          // --cells, the same
  std::size_t nearest = 0;     // --nearest: points to list per part
  double d_max = clearance::infinity;
  clearance::crop where;                    // --crop, --crop-out, --height, --plane: where obstacles are
  std::optional<double> self_filter;        // --self-filter: points within this many metres are the robot's own
  std::optional<support_asked> support;     // --min-support
  std::optional<joints_off> certain;        // any option about uncertainty was given
  std::optional<clearance::hiding> unseen;  // --unseen
  bool gradient = false;
  std::optional<double> deadline;                            // --deadline: milliseconds for the least distance
  bool shard = false;                                        // --shard: one of the ranks that mpirun started
  std::string configurations;                                // for `clearance plan` and `clearance self`
  std::string srdf;                                          // for `clearance self`; empty: all pairs but neighbours
  std::vector<std::pair<std::string, std::string>> allowed;  // --allow: pairs of links that may touch
  bool csv = false;                                          // for all but `clearance query`
  bool between = false;                                      // for `clearance plan`
  std::optional<bool> fields;      // for `clearance plan` and the plan of `clearance run`; auto: not given
  recording_options recording;     // for `clearance run`
  std::vector<std::string> notes;  // about options that are given together
  std::vector<std::pair<std::string, std::string>> alike;  // for --shard: what ranks must be given alike, by name

  bool plans() const { return !configurations.empty() || !recording.plan.empty(); }
};

/// Are so many configurations asked about with fields? If not said by --fields: sampled where that costs less than it
/// saves, else if they are kept.
field_use uses_fields(const query_options& asked, std::size_t configurations);

enum class asking { query, run, plan, self };

/// Declares a subcommand's options; the returned function reads them after parsing. Throws usage_error.
std::function<query_options()> add_query_options(CLI::App& app, asking how);
