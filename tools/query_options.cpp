// SPDX-License-Identifier: BSD-3-Clause
#include "query_options.hpp"

#include "cloud_options.hpp"
#include "command_line.hpp"
#include "option_table.hpp"

#include <clearance/ground/pose.hpp>
#include <clearance/io/cloud_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string_view>
#include <utility>

namespace {

constexpr std::size_t most_listed = std::size_t(1) << 20;  // the library's limit, for --nearest and --support-limit

using texts = std::vector<std::string>;

struct raw_options {
  std::string robot, joints, geometry, base, model, volume, spheres, packing, cache, backend, check, scene, frames,
      trajectory, unfolded;
  std::string zones, min_points, distances, d_max, configurations, srdf, plan, self_filter, min_support, support_limit,
      svg, gltf_up, report, deadline, nearest, delay, max_speed, plan_time, joint_error, joint_speed, stamps, max_age;
  std::optional<std::string> unseen, fields;  // without a value: empty
  texts attached, attached_poses, joint, packages, mesh_limits, excluded, clouds, poses, links, cameras, scales,
      cloud_scales, ranges, sensors, calibrations, crops, crops_out, heights, planes, allowed;
  bool ignore_limits = false, strict = false, json = false, no_cache = false, merge = false, csv = false,
       gradient = false, shard = false, is_signed = false, between = false, cells = false;
};

/// A number that is not negative.
double amount(const std::string& option, const std::string& text, const char* unit) {
  const double x = number(option, text) + 0.0;  // no -0
  if (!(x >= 0 && x <= 1e15)) throw usage_error(option, std::string("must be from 0 to 1e15 (") + unit + ")");
  return x;
}

constexpr const char* of_fields =
    "on (also without a value), off or auto (default): sample a table around each link first (1 MiB; up to seconds a "
    "link on a host, 5 ms on a GPU), once: the cache keeps it. Configurations take less time then, and every answer is "
    "the same; auto, without --d-max: sample for 100,000 and more (rows times frames), and take what the cache has for "
    "100 "
    "(on a GPU 10,000) and more";

void add_fields(CLI::App& app, raw_options& raw) {
  app.add_option_function<std::vector<std::string>>(
         "--fields",
         [&raw](const std::vector<std::string>& given) { raw.fields = given.empty() ? std::string() : given[0]; },
         of_fields)
      ->expected(0, 1);
}

/// The objects that links hold; a pose belongs to the object before it.
std::vector<attachment_options> attached_of(const CLI::App& app) {
  std::vector<attachment_options> things;
  bool placed = false;
  for (const auto& [name, text] : in_order(app)) {
    if (name == "--attach") {
      const auto [link, file] = assignment(name, text, "LINK=FILE");
      things.push_back({.link = link, .file = file});
      placed = false;
    } else if (name == "--attach-pose") {
      if (things.empty()) throw usage_error(name, "is for the --attach before it, and there is none");
      if (std::exchange(placed, true)) throw usage_error(name, "is given twice for " + things.back().file);
      try {
        things.back().pose = clearance::rigid(pose(name, text), "what is attached");
      } catch (const usage_error&) {
        throw;
      } catch (const std::invalid_argument& error) {
        throw usage_error(name, without_prefix(error.what()));
      }
    }
  }
  return things;
}

/// Metres, 0 or more, small enough to be squared.
double length(const std::string& option, const std::string& text) {
  const double metres = number(option, text);
  if (!(metres >= 0 && metres <= 1e15)) throw usage_error(option, "must be from 0 to 1e15 (metres)");
  return metres;
}

/// NEAR:FAR; without a text the usual ones.
clearance::hiding room_of(const std::string& option, const std::string& text) {
  clearance::hiding room;
  if (text.empty()) return room;
  const std::size_t at = text.find(':');
  if (at == text.npos)
    throw usage_error(option, clearance::io::quoted(text) + " is not of the form NEAR:FAR, such as 0.1:10");
  const double from = number(option, text.substr(0, at)), to = number(option, text.substr(at + 1));
  room.nearest = clearance::real(from);
  room.farthest = clearance::real(to);
  if (!(room.nearest > 0 && room.nearest < room.farthest && to <= 1e6))
    throw usage_error(option, "needs 0 < NEAR < FAR <= 1e6 (metres along z)");
  return room;
}

support_asked support_of(const std::string& option, const std::string& text) {
  const std::size_t at = text.find('@');
  if (at == text.npos)
    throw usage_error(option, clearance::io::quoted(text) + " is not of the form N@RADIUS, such as 3@0.02");
  const std::size_t points = whole_number(option, text.substr(0, at));
  if (points < 2) throw usage_error(option, "needs at least 2 points: one alone always confirms itself");
  return {.min_points = std::uint32_t(points), .radius = length(option, text.substr(at + 1))};
}

std::vector<double> thresholds(const std::string& option, const std::string& text) {
  const auto values = numbers(option, text);
  if (values[0] < 0 || !std::is_sorted(values.begin(), values.end()))
    throw usage_error(option, "needs thresholds in ascending order, none below 0 (metres)");
  return values;
}

/// How is asked: until when, and by which ranks.
void read_deadline(const raw_options& raw, query_options& o) {
  if (!raw.deadline.empty()) {
    const double milliseconds = number("--deadline", raw.deadline);
    if (!(milliseconds >= 0 && milliseconds <= 1e9))
      throw usage_error("--deadline", "must be from 0 to 1e9 (milliseconds)");
    o.deadline = milliseconds + 0.0;  // no -0
    if (o.volume != usual_volume(o.model))
      throw usage_error("--volume", std::string("cannot be ") + to_string(o.volume) + " with --deadline, which has " +
                                        to_string(usual_volume(o.model)) + " for --model " + to_string(o.model));
  }
  o.shard = raw.shard;
}

/// Where obstacles are.
void read_crop(const raw_options& raw, query_options& o) {
  const auto each = [](const char* option, const texts& given, std::size_t count, const char* what, const auto& add) {
    for (const std::string& text : given) {
      const std::vector<double> values = numbers(option, text, count, what, true);
      try {
        add(values);
      } catch (const std::invalid_argument& error) {
        throw usage_error(option, without_prefix(error.what()));
      }
    }
  };
  const auto corner = [](const std::vector<double>& v, int first) {
    return Eigen::Vector3d(v[std::size_t(first)], v[std::size_t(first) + 1], v[std::size_t(first) + 2]);
  };
  constexpr const char* corners = "x0,y0,z0,x1,y1,z1";
  each("--crop", raw.crops, 6, corners, [&](const auto& v) { o.where.inside(corner(v, 0), corner(v, 3)); });
  each("--crop-out", raw.crops_out, 6, corners, [&](const auto& v) { o.where.outside(corner(v, 0), corner(v, 3)); });
  each("--height", raw.heights, 2, "low,high", [&](const auto& v) { o.where.height(v[0], v[1]); });
  each("--plane", raw.planes, 5, "a,b,c,d,thickness",
       [&](const auto& v) { o.where.without_plane(corner(v, 0), v[3], v[4]); });
}

/// What is uncertain about clouds and joints. It is for all clouds, but for --sensor and --calibration.
void read_uncertainty(const raw_options& raw, query_options& o) {
  joints_off off;
  if (!raw.delay.empty()) off.delay = amount("--delay", raw.delay, "seconds");
  const double speed = raw.max_speed.empty() ? 0 : amount("--max-speed", raw.max_speed, "m/s");
  const double later = raw.plan_time.empty() ? 0 : amount("--plan-time", raw.plan_time, "seconds");
  const bool alone = !raw.configurations.empty();
  const auto each = [](const char* option, const std::string& text) {
    std::vector<double> values;
    if (!text.empty()) values = numbers(option, text);
    return values;
  };
  off.errors = each("--joint-error", raw.joint_error);
  off.speeds = each("--joint-speed", raw.joint_speed);
  for (const double x : off.errors)
    if (!(x >= 0)) throw usage_error("--joint-error", "needs 0 or more (rad, m)");
  if (!raw.sensors.empty() || !raw.calibrations.empty() || !raw.max_speed.empty() || !raw.joint_error.empty() ||
      !raw.joint_speed.empty())
    o.certain = off;
  const auto set_age = [&](cloud_options& cloud) {
    cloud.off.max_speed = speed;
    cloud.off.age = off.delay + (alone ? later : 0);
    cloud.later = alone ? 0 : later;
  };
  set_age(o.recording.camera);
  for (cloud_options& cloud : o.clouds) set_age(cloud);
}

/// Throws if an option is about spheres, but the model has none; or about what is kept, but nothing is.
void check_model(const query_options& o) {
  if (o.model == model_kind::spheres) return;
  for (const auto& [option, given] : {std::pair("--packing", !o.packing.empty()), {"--spheres", o.spheres.has_value()}})
    if (given) throw usage_error(option, "is for --model spheres");
  if (o.plans() && uses_fields(o, ~std::size_t(0)) != field_use::none) return;
  for (const auto& [option, given] : {std::pair("--cache", !o.cache.empty()), {"--no-cache", o.no_cache}})
    if (given) throw usage_error(option, "is for --model spheres, and for --fields");
}

/// The questions besides the least distance.
void read_questions(const raw_options& raw, query_options& o) {
  if (!raw.check.empty()) {
    o.margin = number("--check", raw.check) + 0.0;  // no -0
    if (!(*o.margin >= 0))
      throw usage_error("--check", "must not be negative (metres): the lower end is 0 in a collision, too");
  }

  if (!raw.zones.empty()) o.zones = thresholds("--zones", raw.zones);
  if (!raw.min_points.empty()) o.min_points = whole_number("--min-points", raw.min_points);
  o.distances = raw.distances;
  if (!o.distances.empty() && clearance::io::extension(o.distances) != ".ply")
    throw usage_error("--distances", o.distances + ": its name must end in .ply, which is what is written");
  o.is_signed = raw.is_signed;
  o.cells = raw.cells;
  if (o.is_signed && o.model != model_kind::triangles)
    throw usage_error("--signed", "is for --model triangles: distances to spheres are signed already");
  if (!raw.nearest.empty()) o.nearest = whole_number("--nearest", raw.nearest, most_listed);
  if (!raw.self_filter.empty()) o.self_filter = length("--self-filter", raw.self_filter);
  if (!raw.min_support.empty()) o.support = support_of("--min-support", raw.min_support);
  if (raw.unseen) {
    o.unseen = room_of("--unseen", *raw.unseen);
    for (const cloud_options& cloud : o.clouds) cloud.check_hides();
  }
  if (!raw.support_limit.empty()) o.support->most = whole_number("--support-limit", raw.support_limit, most_listed);

  o.gradient = raw.gradient;
  o.configurations = raw.configurations;
  o.csv = raw.csv;
  o.between = raw.between;
  o.recording.plan = raw.plan;
  if (raw.fields) {
    const std::size_t how = raw.fields->empty() ? 0 : choice("--fields", *raw.fields, {"on", "off", "auto"});
    if (how != 2) o.fields = how == 0;
  }

  o.recording.svg = raw.svg;
  if (!raw.svg.empty() && clearance::io::extension(raw.svg) != ".svg")
    throw usage_error("--svg", raw.svg + ": its name must end in .svg, which is what is written");
  if (!raw.report.empty())
    throw usage_error("--report",
                      "is of the Python package, whose command takes all of these options: python3 -m "
                      "clearance run --report " +
                          raw.report + " ...");
  if (!raw.d_max.empty()) {
    o.d_max = number("--d-max", raw.d_max);
    if (!(o.d_max > 0)) throw usage_error("--d-max", "must be above 0 (metres)");
    if (!(o.d_max >= 1e-30 && o.d_max <= 1e30)) throw usage_error("--d-max", "must be from 1e-30 to 1e30 (metres)");
    if (!o.configurations.empty() && o.margin && !(o.d_max > *o.margin))
      throw usage_error("--d-max", "must be above the margin of --check, or nothing could pass");
  }
}

/// Bytes made per point by these questions, or time worth as many.
std::uint64_t bytes_each(const query_options& o) {
  std::uint64_t bytes = 16;
  for (const bool asked : {!o.zones.empty(), o.nearest != 0, o.support.has_value(), o.self_filter.has_value(),
                           o.certain.has_value(), o.unseen.has_value(), o.model == model_kind::triangles})
    if (asked) bytes += 16;
  if (!o.distances.empty()) bytes += 64;  // the result, and a record of the file
  if (!o.scene.empty()) bytes += 128;     // several copies of position and colour
  if (o.plans()) bytes += 80;             // a tree
  if (o.recording.merge) bytes += 64;
  return bytes;
}

query_options read(const CLI::App& app, const raw_options& raw) {
  check_given_once(app);
  query_options o;
  o.notes = check_together(app);
  o.alike = given_alike(app);

  o.robot = raw.robot;
  if (!raw.joints.empty()) o.joints = numbers("--joints", raw.joints);
  for (const auto& text : raw.joint) {
    const auto [name, value] = assignment("--joint", text);
    for (const auto& before : o.joint)
      if (before.first == name) throw usage_error("--joint", name + " is given twice");
    o.joint.emplace_back(name, number("--joint " + name, value));
  }
  if (!o.joints.empty() && !o.joint.empty()) throw usage_error("--joints", "cannot be mixed with --joint");
  if (!o.joints.empty() && !raw.configurations.empty())
    throw usage_error("--joints", "cannot be mixed with --configurations");
  o.srdf = raw.srdf;
  for (const auto& text : raw.allowed) o.allowed.push_back(assignment("--allow", text, "LINK=LINK"));

  o.ignore_limits = raw.ignore_limits;
  o.strict = raw.strict;
  if (!raw.geometry.empty()) o.visual = choice("--geometry", raw.geometry, {"collision", "visual"}) == 1;
  o.packages = packages_of(raw.packages);
  o.gltf_up = gltf_axis_of(raw.gltf_up);
  o.limits = limits_of(raw.mesh_limits);
  if (!raw.base.empty()) o.base = pose("--base-pose", raw.base);
  if (!raw.unfolded.empty())
    o.recording.camera.limits.unfolded = std::uint64_t(whole_number("--unfold-limit", raw.unfolded)) << 20;
  o.clouds = clouds_of(app, o.recording.camera);
  o.attached = attached_of(app);

  o.recording.frames = raw.frames;
  o.recording.trajectory = raw.trajectory;
  o.recording.stamps = raw.stamps;
  if (!raw.max_age.empty()) o.recording.max_age = amount("--max-age", raw.max_age, "seconds");
  o.recording.merge = raw.merge;

  o.model = model_kind(choice("--model", raw.model, {"spheres", "triangles"}));
  o.volume = usual_volume(o.model);
  if (!raw.volume.empty()) o.volume = volume_kind(choice("--volume", raw.volume, {"sphere", "aabb", "obb"}));
  if (!raw.spheres.empty()) o.spheres = whole_number("--spheres", raw.spheres);
  o.packing = raw.packing;
  o.no_cache = raw.no_cache;
  o.cache = raw.cache;
  o.excluded = raw.excluded;
  if (app.get_option_no_throw("--backend"))
    o.on_device = raw.backend.empty() ? find_device().present : is_device(raw.backend);
  o.json = raw.json;
  o.scene = raw.scene;

  read_crop(raw, o);
  read_uncertainty(raw, o);
  read_questions(raw, o);
  check_model(o);
  read_deadline(raw, o);
  o.recording.camera.bytes_each = bytes_each(o);
  for (cloud_options& cloud : o.clouds) cloud.bytes_each = o.recording.camera.bytes_each;
  return o;
}

/// The options of the robot and its models.
void add_robot_options(CLI::App& app, raw_options& raw) {
  app.add_flag("--ignore-limits", raw.ignore_limits, "Accept joint positions outside their limits");
  app.add_option("--geometry", raw.geometry, geometry_says);
  app.add_flag("--strict", raw.strict, "Refuse of the robot's description what would get a note");
  app.add_option("--package", raw.packages, package_says);
  app.add_option("--gltf-up", raw.gltf_up, gltf_up_says);
  app.add_option("--mesh-limit", raw.mesh_limits, mesh_limit_says());
  app.add_option("--base-pose", raw.base,
                 "x,y,z,qx,qy,qz,qw: world-from-base (m; default: the base is at the world's origin)");
}

/// The options for the robot's configuration.
void add_joint_options(CLI::App& app, raw_options& raw, asking how) {
  const bool recorded = how == asking::run, planned = how == asking::plan;
  if (recorded) {
    app.add_option("--frames", raw.frames,
                   "Point clouds (.pcd .ply .xyz .txt) or 16-bit depth images (.png): a folder, in the order of their "
                   "names, or a "
                   "text file with one path per "
                   "line, relative to that file")
        ->required();
    app.add_option(
        "--trajectory", raw.trajectory,
        "CSV: a line with the names of the joints, then one row per frame, or one row for all (rad, m); not needed if "
        "no joint is free");
    app.add_option("--stamps", raw.stamps,
                   "A text file with one number per frame and line, when the frame was seen (s): the trajectory's rows "
                   "are then samples, with their times in a column named time, and joints are interpolated between the "
                   "two around a frame; beside a single one --joint-speed widens what is certain");
    app.add_option("--max-age", raw.max_age,
                   "Seconds: refuse frames without a sample of the joints that is so near (default 0.1)");
    app.add_flag("--merge", raw.merge,
                 "Ask every frame about the clouds of all frames, merged in the world: each frame's cloud is put there "
                 "by --camera-pose, with "
                 "--camera-link by that link's pose in the frame's row of the trajectory");
    app.add_option(
        "--plan", raw.plan,
        "CSV as --trajectory: configurations to come, one a row; every frame says how near they are to its points, and "
        "with --check which is the "
        "first that is too near");
    add_fields(app, raw);
    app.add_option("--joint", raw.joint, "name=value: a joint that has no column in the trajectory (and in the plan)");
  } else if (planned) {
    app.add_option("--configurations", raw.configurations,
                   "CSV: a line with the names of the joints, then one configuration a row (rad, m)")
        ->required();
    app.add_option("--joint", raw.joint, "name=value: a joint that has no column");
  } else {
    app.add_option("--joints", raw.joints,
                   "a,b,...: joint positions (rad, m) in the file's order of movable, non-mimic joints");
    app.add_option("--joint", raw.joint, "name=value: the position of one joint; others are 0 or their nearest limit");
    if (how == asking::self)
      app.add_option("--configurations", raw.configurations,
                     "Instead: CSV, a line with the names of the joints, then one configuration a row; --joint for one "
                     "that has no column");
  }
}

void add_cloud_options(CLI::App& app, raw_options& raw, asking how) {
  const bool recorded = how == asking::run, planned = how == asking::plan;
  if (!recorded)
    app.add_option("--cloud", raw.clouds, "Point cloud (.pcd .ply .xyz) or 16-bit depth image (.png); may be repeated")
        ->required();
  app.add_option("--camera-pose", raw.poses,
                 "x,y,z,qx,qy,qz,qw: world-from-cloud, or link-from-cloud with --camera-link");
  app.add_option(
      "--camera-link", raw.links,
      std::string("The link that carries the camera") + (planned ? ", where it is in the first configuration" : ""));
  app.add_option("--intrinsics", raw.cameras, "fx,fy,cx,cy of a depth image, pixels");
  app.add_option("--depth-scale", raw.scales, "Metres per unit of a depth image (default 0.001)");
  app.add_option("--cloud-scale", raw.cloud_scales,
                 "Metres per unit of a point cloud (default 1; Zivid's and ZED's millimetres: 0.001)");
  app.add_option("--range", raw.ranges,
                 "near,far: other points do not count (m; along z for images, else from the sensor)");
  app.add_option("--crop", raw.crops,
                 "x0,y0,z0,x1,y1,z1: only points in that box (m, in the world; inf has no end) are obstacles. All four "
                 "of these options may be repeated, to four in all, and the dropped points are counted as cropped");
  app.add_option("--crop-out", raw.crops_out, "x0,y0,z0,x1,y1,z1: no point in that box is an obstacle");
  app.add_option("--height", raw.heights, "low,high: only points from low to high along the world's z are obstacles");
  app.add_option("--plane", raw.planes,
                 "a,b,c,d,thickness: no point within thickness (m) of the plane ax + by + cz = d of the world is an "
                 "obstacle, such as a table's: 0,0,1,0.7,0.02");
  app.add_option(
      "--unfold-limit", raw.unfolded,
      "MiB that one compressed cloud or image may become, with all that is made of its points or pixels here (default "
      "1024)");
  app.add_flag("--use-viewpoint")->description("Apply the VIEWPOINT of a PCD file");
  app.add_flag("--zero-is-missing")->description("(0,0,0) is no point");
}

void add_uncertainty(CLI::App& app, raw_options& raw, asking how) {
  app.add_option(
      "--sensor", raw.sensors,
      "kinect, stereo:F,B,S (pixels, m, pixels), tof:C,S (m, m/m2) or lidar:C,S (m, m/m): points may be three "
      "deviations of this sensor's noise away; says what is certain then, and --check is about that");
  app.add_option("--calibration", raw.calibrations,
                 "DT,DTHETA: by how much the cloud's pose may be wrong (m, rad about the sensor)");
  app.add_option("--delay", raw.delay, "Seconds from what was seen and the joints' positions until the answer counts");
  app.add_option("--max-speed", raw.max_speed, "m/s: no obstacle is faster, in the time of --delay");
  if (how != asking::query)
    app.add_option("--plan-time", raw.plan_time,
                   "Seconds from when the answer counts to the end of the plan: obstacles may move until then");
  app.add_option("--joint-error", raw.joint_error,
                 std::string("By how much joints may be wrong (rad, m): one number, or one each ") +
                     (how == asking::query ? "as for --joints" : "in the robot's order"));
  app.add_option("--joint-speed", raw.joint_speed,
                 "How fast joints move, in the time of --delay (rad/s, m/s): one number, or one each");
}

void add_model_options(CLI::App& app, raw_options& raw, asking how) {
  const bool recorded = how == asking::run, planned = how == asking::plan, itself = how == asking::self;
  if (!itself) app.add_option("--model", raw.model, "spheres (default) or triangles");
  if (!planned && !itself)
    app.add_option(
        "--volume", raw.volume,
        "sphere, aabb or obb, for the least distance alone (default: sphere for spheres, obb for triangles)");
  app.add_option("--spheres", raw.spheres, "Inner spheres per link that is packed (default 2048)");
  app.add_option("--packing", raw.packing, "The links' spheres: .ist (from clearance pack), .yaml as for cuRobo, .csv");
  app.add_flag("--no-cache", raw.no_cache, "Pack anew, and keep nothing");
  app.add_option("--cache", raw.cache,
                 "Keep packings and fields in this folder (default: $CLEARANCE_CACHE, $XDG_CACHE_HOME/clearance, "
                 "~/.cache/clearance)");
  app.add_option("--exclude-link", raw.excluded, "Leave out this link's geometry");
  app.add_option("--attach", raw.attached,
                 "LINK=FILE: this link holds something, which counts as a part of the robot: a mesh, or spheres (.ist, "
                 ".yaml, .csv); may be repeated");
  app.add_option("--attach-pose", raw.attached_poses,
                 "x,y,z,qx,qy,qz,qw: link-from-thing, of the --attach before it (m; default: the link's origin)");
  if (!itself) app.add_option("--backend", raw.backend, "host or device (default: device where there is one)");
  app.add_option("--check", raw.check,
                 std::string("Margin in m: exit code 2 unless the lower end of the bracket is above it") +
                     (recorded            ? " in every frame, and for every row of --plan"
                      : planned || itself ? " in every configuration"
                                          : ""));
}

const char* const of_clouds =
    "--camera-pose, --camera-link, --intrinsics, --depth-scale, --cloud-scale, --range, --sensor, --calibration, "
    "--use-viewpoint and\n"
    "--zero-is-missing hold "
    "for all clouds if given before the first --cloud, else for the --cloud before them.";

void add_shard(CLI::App& app, raw_options& raw) {
  app.add_flag("--shard", raw.shard,
               "Under mpirun: each rank asks about its share of every cloud, and rank 0 prints the one answer");
}

void add_unseen(CLI::App& app, raw_options& raw) {
  app.add_option_function<std::vector<std::string>>(
         "--unseen",
         [&raw](const std::vector<std::string>& given) { raw.unseen = given.empty() ? std::string() : given[0]; },
         std::string("NEAR:FAR (m along z; default 0.1:10): how far each link is from what no depth image shows: from "
                     "a pixel's depth, or without one from NEAR on, up to FAR; --check is about that, too") +
             (app.get_option_no_throw("--self-filter") ? "; what the points of --self-filter hide is told apart" : ""))
      ->expected(0, 1);
}

void add_plan_questions(CLI::App& app, raw_options& raw) {
  app.add_option("--d-max", raw.d_max,
                 "Metres: configurations that are farther from every point are only said to be so, which is quicker");
  app.add_flag("--between", raw.between,
               "Judge also the way from each configuration to the next, every joint at constant speed: no point is "
               "nearer than its lower end at any time; "
               "--check is about the ways, too");
  add_fields(app, raw);
  add_unseen(app, raw);
  app.add_flag("--csv", raw.csv, "Print CSV; without it, one JSON object per configuration and a last one about all");
  add_shard(app, raw);
  app.footer(std::string(of_clouds) + "\nThe exit code is 3 without a valid point, also with --check.");
}

void add_self_filter(CLI::App& app, raw_options& raw) {
  app.add_option(
      "--self-filter", raw.self_filter,
      "Metres: hide the points that certainly are within that of the robot, or of what it holds, from all questions, "
      "--check among them; says how many "
      "they are; exit code 3 if none is left");
}

void add_run_questions(CLI::App& app, raw_options& raw) {
  add_self_filter(app, raw);
  add_unseen(app, raw);
  app.add_flag("--csv", raw.csv, "Print CSV, one row per frame; without it, one JSON object per frame");
  app.add_option(
      "--svg", raw.svg,
      "Write a picture to this .svg file once all frames are answered: the distance in every frame, in the band of "
      "its bracket; with bands of what is certain and of what is unseen, if they are asked for");
  app.add_option("--report", raw.report,
                 "Write one HTML page about all frames; of the Python package: python3 -m clearance run --report ...");
  app.footer(
      "Prints one line per frame, a JSON object. latency_us is the time of the query alone, on the host's clock; a "
      "frame's points\n"
      "are read before. The exit code is 3 if a frame has no valid point, also with --check.");
}

void add_self_questions(CLI::App& app, raw_options& raw) {
  app.add_option(
      "--srdf", raw.srdf,
      "The robot's SRDF file: which pairs of links can meet, as MoveIt reads it (default: all but neighbours "
      "in the robot's joints)");
  app.add_option("--allow", raw.allowed, "LINK=LINK: these two may touch, and are not asked about; may be repeated");
  app.add_flag("--json", raw.json, "Print one JSON object; with --configurations one a row, and a last one about all");
  app.add_flag("--csv", raw.csv, "With --configurations: print CSV");
  app.footer(
      "Links are asked about by their inner spheres, on the CPU.\n"
      "Exit codes: 0 done; 1 an error, wrong usage included; 2 --check fails.");
}

void add_query_questions(CLI::App& app, raw_options& raw) {
  app.add_flag("--json", raw.json, "Print one JSON object");
  app.add_option("--scene", raw.scene,
                 "Write robot, clouds and witness to this .glb file; with --distances in their colours");
  app.add_option(
      "--zones", raw.zones,
      "a,b,... (m, ascending): how many points may be within these distances of each link, and which; exit code 2 if "
      "there are any in the first; with --sensor and its kin wherever points and links may be");
  app.add_option("--min-points", raw.min_points, "A zone with fewer points counts as empty (default 1)");

  app.add_option(
      "--distances", raw.distances,
      "Write every valid point with its distance to this .ply file, in world coordinates; red at 0 m, blue at --d-max "
      "(or 1 m) and beyond");
  app.add_flag("--signed", raw.is_signed,
               "With --distances and --model triangles: below 0 inside a closed mesh, by how deep; without it 0 there");
  app.add_flag(
      "--cells", raw.cells,
      "With --distances on a GPU: list around each link first which spheres or triangles can be nearest (up to "
      "64 MiB and a second a link). Distances take less time then, and every answer is the same");
  app.add_option("--nearest", raw.nearest,
                 "How many points to list of each link, the nearest first, with what is certain of each");
  app.add_option(
      "--d-max", raw.d_max,
      "Metres: points farther than that are written as inf by --distances, and not listed by --nearest (default: "
      "none)");
  add_self_filter(app, raw);
  app.add_option(
      "--min-support", raw.min_support,
      "N@RADIUS, such as 3@0.02: say also how far the nearest point is that has N points, itself among them, within "
      "RADIUS m; --check stays about all points");
  add_unseen(app, raw);
  app.add_option(
      "--support-limit", raw.support_limit,
      "How many of the nearest points --min-support asks before it gives up (default 4096, at most 1048576)");
  app.add_flag("--gradient", raw.gradient,
               "How each part's distance changes with its pose, and with the joints: m per m and m per rad of a twist "
               "at the part's origin");
  app.add_option(
      "--deadline", raw.deadline,
      "Milliseconds for the least distance: what is known by then is the answer, with how many points are unseen, "
      "which may be anywhere; parts have none");
  add_shard(app, raw);
  app.footer(std::string(of_clouds) + '\n' + exit_codes);
}

}  // namespace

field_use uses_fields(const query_options& asked, std::size_t configurations) {
  // bench/records/xeon/fields_pay.txt, bench/records/epyc/kept_fields.txt
  constexpr std::size_t sampling_pays_from = 100'000, reading_pays_from[] = {100, 10'000};
  if (asked.fields) return *asked.fields ? field_use::always : field_use::none;
  if (asked.d_max < clearance::infinity || configurations < reading_pays_from[asked.on_device]) return field_use::none;
  return configurations < sampling_pays_from ? field_use::if_cached : field_use::always;
}

std::function<query_options()> add_query_options(CLI::App& app, asking how) {
  auto raw = std::make_shared<raw_options>();
  raw->model = "spheres";
  app.add_option("--robot", raw->robot, "Robot description, URDF")->required();
  add_joint_options(app, *raw, how);
  add_robot_options(app, *raw);
  if (how != asking::self) {
    add_cloud_options(app, *raw, how);
    add_uncertainty(app, *raw, how);
  }
  add_model_options(app, *raw, how);
  switch (how) {
    case asking::self:
      add_self_questions(app, *raw);
      break;
    case asking::plan:
      add_plan_questions(app, *raw);
      break;
    case asking::run:
      add_run_questions(app, *raw);
      break;
    default:
      add_query_questions(app, *raw);
  }
  return [raw, &app] { return read(app, *raw); };
}
