// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The only way from the command to what the library does on a backend: plain data in, plain data out, so that each backend
// is one translation unit and only device.cu needs nvcc.

#include <clearance/packing/packing.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/result.hpp>
#include <clearance/solid/mesh_solid.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

enum class model_kind { spheres, triangles };
enum class volume_kind { sphere, aabb, obb };

inline const char* to_string(model_kind kind) { return kind == model_kind::spheres ? "spheres" : "triangles"; }
inline const char* to_string(volume_kind kind) {
  return kind == volume_kind::sphere ? "sphere" : kind == volume_kind::aabb ? "aabb" : "obb";
}

/// One rigid body: what its models are built from.
struct body {
  std::string name;
  clearance::packing packed;      // for spheres; empty if nobody asks
  clearance::closed_mesh closed;  // for triangles
  double tolerance = 0;           // how far the true surface may be from the mesh, m
};

struct seen_points {
  std::variant<clearance::point_span, clearance::depth_image<std::uint16_t>> points;
  Eigen::Isometry3d pose;  // world-from-points
};

struct question {
  model_kind model = model_kind::spheres;
  volume_kind volume = volume_kind::sphere;
  const std::vector<body>* bodies = nullptr;
  std::vector<Eigen::Isometry3d> poses;  // world-from-body
  std::vector<seen_points> clouds;
  int repeat = 1;  // ask up to so often, while that takes little, and report the shortest time
};

struct reply {
  clearance::min_distance_result result;
  std::vector<clearance::part_minimum> parts;
  double build = 0, upload = 0, query = 0;  // seconds
};

reply ask_host(const question& asked);

/// Throws std::runtime_error if no device is compiled in.
reply ask_device(const question& asked);

/// A question that is asked again and again, of the same bodies: the library's prepared query.
class prepared_question {
 public:
  virtual ~prepared_question() = default;

  /// Takes the points to where the backend reads them; they and what they view stay until the next ones. Seconds spent.
  virtual double see(const seen_points& cloud) = 0;

  /// The minimum over what was seen last; .query is the time of that alone, and no .parts are told.
  virtual reply ask(const std::vector<Eigen::Isometry3d>& poses) = 0;
};

/// Builds the models that are asked for; poses and clouds come later.
std::unique_ptr<prepared_question> prepare_host(const question& asked);
std::unique_ptr<prepared_question> prepare_device(const question& asked);

/// As clearance::pack, on the device; from any thread. Throws std::runtime_error if no device is compiled in.
clearance::packing pack_on_device(const clearance::mesh_solid& solid, const clearance::pack_options& options);

struct device_state {
  bool compiled = false, present = false;
  std::string says;  // which device, or why there is none
};

device_state find_device();
