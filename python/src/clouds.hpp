// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds in Python: views of arrays where they lie.

#include "asker.hpp"
#include "seen_array.hpp"

#include <clearance/frames/cropped_clouds.hpp>

#include <nanobind/nanobind.h>

#include <optional>

namespace nb = nanobind;

/// What is uncertain about a cloud.
struct cloud_doubts {
  clearance::any_noise noise;
  clearance::cloud_uncertainty of;
  int device = on_the_host;  ///< Where the radii of `noise` lie, if it has those.
  nb::object kept;
};

/// A cloud with its pose, and what keeps its memory alive.
struct cloud_object {
  whole_cloud cloud;
  clearance::crop where;  ///< Its points that are obstacles, in world coordinates.
  std::optional<cloud_doubts> doubts;
  int device = on_the_host;  ///< The CUDA device where the array lies.
  bool far = false;          ///< Doubles, of which a place near the robot is subtracted before they become floats.
  Eigen::Vector3d sensor = Eigen::Vector3d::Zero();  ///< Of their filter, before it became floats.
  nb::object kept, also_kept;
  const clearance::point_label* labels = nullptr;  ///< One a point: those labelled `own` are hidden. In host memory.
  nb::object recipe = {};  ///< (maker, arguments, named ones), for pickle; of a cloud that Python holds.
};

/// For a robot at this place, cropped: doubles far from (0, 0, 0) become floats relative to a place near it.
any_cloud near_robot(const cloud_object& cloud, const Eigen::Vector3d& robot);

cloud_object cloud_of_points(nb::handle points, nb::handle pose, double nearest, double farthest, nb::handle sensor,
                             bool zero_is_missing);
cloud_object depth_of(nb::handle depth, nb::handle intrinsics, nb::handle pose, nb::handle scale, double nearest,
                      double farthest, bool minus_infinity_is_near, nb::handle rays);

/// The same cloud without what is no obstacle by its place.
cloud_object cropped_of(nb::handle cloud, nb::handle inside, nb::handle outside, nb::handle pose, nb::handle height,
                        nb::handle plane);

/// The same cloud, whose points may be elsewhere. `noise`: None, one of the library's, or an array of radii.
cloud_object uncertain_of(nb::handle cloud, nb::handle noise, double shift, double turn, double max_speed, double age);

/// The same cloud without the points that are labelled `own`, or of which a bool is true.
cloud_object masked_of(nb::handle cloud, nb::handle labels);

void bind_clouds(nb::module_& m);
