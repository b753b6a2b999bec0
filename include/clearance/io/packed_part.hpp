// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A part's spheres as files of any format hold them.

#include <clearance/io/digest.hpp>
#include <clearance/packing/packing.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace clearance::io {

/// One part of a robot, as a file of spheres holds it.
struct packed_part {
  std::string name;      ///< The link; may be empty.
  packing spheres;       ///< In the part's frame. Without a certificate the gap is infinite.
  double tolerance = 0;  ///< How far the packed mesh may differ from the true surface, metres (tessellation). If read
                         ///< from a file, it includes the spheres' own tolerance.
  digest solid;          ///< Digest of the certified mesh.
  digest recipe;         ///< Digest of that mesh and the options of `pack`; see packing_key.
};

/// A packing of which only the spheres are known, in the order given.
packing uncertified(std::vector<inner_sphere> spheres);

/// Returns the sphere, or refuses it: it must be finite, up to 1e18 m, with a radius above 0.
inner_sphere checked_sphere(vec3 center, real radius, const std::string& file, const std::string& which,
                            std::size_t line = 0);

/// The fewest digits that restore the float exactly, whatever the locale.
std::string shortest(float value);

}  // namespace clearance::io
