// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Every point's distance for eyes: a PLY file, and the same colours for a scene.

#include "asked_clouds.hpp"

#include <clearance/distances.hpp>
#include <clearance/io/scene.hpp>

/// What a file of distances holds.
struct distances_written {
  std::size_t points = 0, left_out = 0;  // records that are a point, and that are none
  std::size_t beyond = 0;                // points farther than --d-max
  double blue_at = 1;                    // metres
};

/// Writes the points of all clouds that count to --distances, whole or not at all.
distances_written write_distances(const query_options& asked, const asked_clouds& clouds,
                                  const clearance::point_distances& found);

/// A cloud's points that count, as a scene shows them; with the colours of their distances, where those are known.
/// `first`: the number of the cloud's first point among all clouds' points.
clearance::io::scene_points drawn(const query_options& asked, const observation& cloud, const seen_points& seen,
                                  const clearance::point_distances* found, std::size_t first);
