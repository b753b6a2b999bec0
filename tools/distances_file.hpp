// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance as colours: in a PLY file, and in a scene.

#include "asked_clouds.hpp"

#include <clearance/io/scene.hpp>
#include <clearance/questions/distances.hpp>

/// The contents of a file of distances.
struct distances_written {
  std::size_t points = 0, left_out = 0;  // records that are valid points, and that are not
  std::size_t beyond = 0;                // points farther than --d-max
  double blue_at = 1;                    // metres
};

/// Writes the valid points of all clouds to --distances, completely or not at all.
distances_written write_distances(const query_options& asked, const asked_clouds& clouds,
                                  const clearance::point_distances& found);

/// A cloud's valid points for a scene, coloured by distance if that is known. `first`: the number of the cloud's first
/// point among all clouds' points.
clearance::io::scene_points drawn(const query_options& asked, const observation& cloud, const seen_points& seen,
                                  const clearance::point_distances* found, std::size_t first);

/// Where the points are that are no obstacles by --crop and the like, in the frame of `seen`.
std::vector<clearance::vec3> cropped_points(const seen_points& seen);
