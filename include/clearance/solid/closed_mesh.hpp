// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/solid/enclosure.hpp>
#include <clearance/solid/triangle_mesh.hpp>

namespace clearance {

struct close_options {
  bool orient = true;  ///< Turn triangles that disagree with their neighbours.
  bool cap = true;     ///< Close boundary loops. Without caps an open mesh has no certain inside.
};

struct cap_report {
  std::uint32_t loops = 0;
  double area = 0;  ///< Square metres.
};

/// How it is known what a part encloses: the least certain of its bodies decides.
enum class inside_by : std::uint8_t {
  nothing,  ///< Caps were declined, or nothing has a volume: there is no inside.
  closed,   ///< Every body is closed as it was loaded.
  caps,     ///< Some body is closed by caps over its holes.
  flood,    ///< Some body is no clean solid: what a flood of a grid from outside does not reach is inside as well.
};

inline const char* to_string(inside_by by) {
  switch (by) {
    case inside_by::nothing:
      return "nothing";
    case inside_by::closed:
      return "closed";
    case inside_by::caps:
      return "caps";
    case inside_by::flood:
      return "flood";
  }
  return "";
}

/// What a part's surface is: its triangles as loaded, with corners welded, and then its caps.
struct closed_mesh {
  triangle_mesh surface;  ///< Triangle i < loaded is triangle i of the input (perhaps turned); the rest are caps.
  std::uint32_t loaded = 0;
  /// By triangle: 1 as it is, -1 turned (its body faces inwards), 0 not at all (it repeats others) counts to the
  /// winding number, which then is above 0 in every body.
  std::vector<std::int8_t> counts;
  std::vector<std::uint32_t> body;  ///< By triangle: of which connected surface it is a piece.
  std::vector<bool> encloses;       ///< By body: does it enclose a volume?
  bool closed = false;              ///< Winding numbers are whole everywhere.
  inside_by inside = inside_by::nothing;
  double tolerance = 0;     ///< Metres from the surface within which it is not certain what is inside.
  enclosure_grid enclosed;  ///< What the flood did not reach; empty where it was not needed.
  cap_report caps;
  std::uint32_t welded = 0;      ///< Vertices that were made one with an earlier one, or that no triangle used.
  std::uint32_t degenerate = 0;  ///< Triangles without area. Kept.
  std::uint32_t duplicate = 0;   ///< Triangles that lie on earlier ones. Kept.
  std::uint32_t flipped = 0;     ///< Triangles that were turned to agree with their neighbours.
  double one_sided_area = 0;     ///< Area of bodies that have no two sides, such as a Moebius strip.
  double area = 0;               ///< Of all loaded triangles.
};

}  // namespace clearance
