// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The command's only way to what the library does on a backend: plain data in and out.

#include <clearance/packing/packing.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/uncertain.hpp>
#include <clearance/result.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <typeindex>
#include <utility>
#include <variant>
#include <vector>

namespace clearance {
struct zones;
struct zones_result;
struct point_distances;
struct min_distances_result;
struct min_distances_per_part_result;
struct nearest_k_result;
struct self_filter_result;
struct min_distance_supported;
struct supported_distance;
struct motion_clearance_options;
struct motion_clearance_result;
struct part_facts;
struct part_radius;
struct certain_distance_result;
struct unseen;
struct unseen_result;
namespace io {
class joint_motion;
struct body;
}  // namespace io
}  // namespace clearance

enum class model_kind { spheres, triangles };
enum class volume_kind { sphere, aabb, obb };

inline const char* to_string(model_kind kind) { return kind == model_kind::spheres ? "spheres" : "triangles"; }
inline const char* to_string(volume_kind kind) {
  return kind == volume_kind::sphere ? "sphere" : kind == volume_kind::aabb ? "aabb" : "obb";
}

/// The volume of the fastest trees for a model.
inline volume_kind usual_volume(model_kind kind) {
  return kind == model_kind::spheres ? volume_kind::sphere : volume_kind::obb;
}

using clearance::io::body;

struct seen_points {
  std::variant<clearance::point_span, clearance::depth_image<std::uint16_t>> points;
  Eigen::Isometry3d pose;  // world-from-points
  clearance::any_noise sensor = {};
  clearance::cloud_uncertainty off = {};
  double later = 0;                  // seconds more until a plan ends
  clearance::crop_boxes boxes = {};  // which points are obstacles, as the points see them
};

struct reply {
  clearance::min_distance_result result;
  std::vector<clearance::part_minimum> parts;  // of least_per_part
  std::uint64_t unseen = 0;                    // points that least_by had no time for
};

using poses_of = std::span<const Eigen::Isometry3d>;

/// The fields of all bodies, for `plan`: without, only if the cache has all of them, or sampled where it has them not.
enum class field_use { none, if_cached, always };

/// What trees are built from.
struct asked_model {
  model_kind model = model_kind::spheres;
  volume_kind volume = volume_kind::sphere;  // of the trees of `least`
  const std::vector<body>* bodies = nullptr;
  field_use fields = field_use::none;
  std::filesystem::path cache = {};  // a folder for fields; empty: they are not kept
  bool cells = false;                // of all bodies: a device looks into them
};

class all_ranks;
struct backend_memory;
using named_values = std::vector<std::pair<std::string, std::string>>;

/// A robot whose trees a backend holds, and the points that it was shown last. A tree is built and a question prepared
/// when it is first needed.
class backend_robot {
 public:
  /// Throws std::runtime_error if no device is compiled in.
  backend_robot(bool on_device, const asked_model& asked);
  backend_robot(const backend_robot&) = delete;
  ~backend_robot();

  /// From now on all ranks answer together; see `all_ranks`.
  void join(all_ranks& all, const named_values& options);

  /// Takes points to where the backend reads them; what they view must stay until the next call. Returns the seconds.
  double see(const std::vector<seen_points>& clouds);

  /// The least distance, by the library's prepared query. In all questions `poses` are world-from-body.
  reply least(poses_of poses);
  /// The least distance of the robot and of every part. Asked up to `repeat` times from cold while that is quick; the
  /// time is the shortest.
  reply least_per_part(poses_of poses, int repeat);

  // The next ones use trees of one volume per model, because their answers do not depend on it.
  /// The least distance as far as it is known after this many seconds; nothing about single parts.
  reply least_by(poses_of poses, double deadline);
  clearance::zones_result zones(poses_of poses, const clearance::zones& options);
  /// Every point's distance. `is_signed`: negative inside closed meshes; for triangles only.
  clearance::point_distances distances(poses_of poses, double d_max, bool is_signed);
  /// The k nearest points of each part.
  clearance::nearest_k_result nearest(poses_of poses, std::size_t k, double d_max);
  /// Which points belong to the robot itself, within `padding` metres of it?
  clearance::self_filter_result own_points(poses_of poses, double padding);
  clearance::supported_distance supported(poses_of poses, const clearance::min_distance_supported& options);
  /// What is certain of the least distance, by the clouds' sensors and one radius per part, or none.
  clearance::certain_distance_result certain(poses_of poses, std::span<const clearance::part_radius> parts);
  /// The least distance to what the clouds hide, which must all be images. `until_end`: or may hide until the plan
  /// ends.
  clearance::unseen_result unseen(poses_of poses, const clearance::unseen& options, bool until_end);
  /// The witnesses of the minima of least_per_part.
  std::vector<clearance::part_witness> witnesses(poses_of poses, std::span<const clearance::part_minimum> minima);
  /// `poses`: those of one configuration after another.
  clearance::min_distances_result plan(poses_of poses, double d_max);
  /// `plan` about all places where points may be until the plan ends, and parts that may be `radii` elsewhere.
  clearance::min_distances_per_part_result certain_plan(poses_of poses, double d_max, const std::vector<double>& radii);
  /// How near the robot comes on each way.
  std::vector<clearance::motion_clearance_result> ways(std::span<const clearance::io::joint_motion> ways,
                                                       const clearance::motion_clearance_options& options);
  /// How near the robot comes, on each way, to what the clouds hide; the parts' radii are those of `room`.
  /// `unknown`: the robot may reach into that.
  std::vector<clearance::motion_clearance_result> hidden_ways(std::span<const clearance::io::joint_motion> ways,
                                                              const clearance::motion_clearance_options& options,
                                                              const clearance::unseen& room);
  std::span<const clearance::part_facts> facts();

  // After `plan` with fields: for each body that can have none the reason, else empty words. Then none is used.
  std::vector<std::string> without_field;
  std::size_t fields = 0, fields_cached = 0;  // that are used; and how many of them the cache had
  // With cells: for each body that can have none the reason; how many bodies have some, and their bytes.
  std::vector<std::string> without_cells;
  std::size_t cells = 0, cells_bytes = 0;

  // Seconds: for the last question; so far for building trees; and for moving them to where the backend reads them.
  double query = 0, build = 0, upload = 0;

 private:
  struct seen_clouds;

  template <class Interface>
  Interface& prepared(const typename Interface::question_type& q, bool other_volume = false);
  template <class Q, class Ask>
  typename Q::result together(poses_of poses, const Q& q, const Ask& ask);
  template <class Q, class Cloud>
  typename Q::result ask(poses_of poses, const std::vector<Cloud>& clouds, const Q& q);
  bool other_volume() const { return asked_.volume != usual_volume(asked_.model); }

  bool on_device_;
  asked_model asked_;
  all_ranks* ranks_ = nullptr;
  std::unique_ptr<backend_memory> memory_;
  std::unique_ptr<seen_clouds> seen_;
  std::map<std::type_index, std::shared_ptr<void>> queries_;  // by their interface
};

inline std::unique_ptr<backend_robot> robot_on(bool device, const asked_model& asked) {
  return std::make_unique<backend_robot>(device, asked);
}

/// As clearance::pack, on the device; any thread may call it. Throws std::runtime_error if no device is compiled in.
clearance::packing pack_on_device(const clearance::mesh_solid& solid, const clearance::pack_options& options);

struct device_state {
  bool compiled = false, present = false;
  std::string says;  // the device's name, or why there is none
};

device_state find_device();
