// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Finds the inside of a mesh such as robots come with, whatever is wrong with it, and says how well it is known.

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

/// How the inside of a part is known; its least certain body decides.
enum class inside_by : std::uint8_t {
  nothing,  ///< Caps were declined, or nothing has a volume: no inside.
  closed,   ///< Every body was closed as loaded.
  caps,     ///< Some body is closed by caps over its holes.
  flood,  ///< Some body is not a clean solid: what a flood of a grid from outside does not reach counts as inside, too.
};

const char* to_string(inside_by by);

/// A part's surface: its triangles as loaded, with welded corners, followed by its caps.
struct closed_mesh {
  triangle_mesh surface;  ///< Triangle i < loaded is triangle i of the input (perhaps turned); the rest are caps.
  std::uint32_t loaded = 0;
  /// By triangle, how it counts for the winding number: 1 as it is, -1 turned (its body faces inwards), 0 not at all
  /// (it repeats others, or no cap closes its body). The number is then above 0 in every body.
  std::vector<std::int8_t> counts;
  std::vector<std::uint32_t> body;  ///< By triangle: the connected surface to which it belongs.
  std::vector<bool> encloses;       ///< By body: does it enclose a volume?
  bool closed = false;              ///< Winding numbers are integers everywhere.
  inside_by inside = inside_by::nothing;
  double tolerance = 0;     ///< Within this distance of the surface, in metres, it is uncertain what is inside.
  enclosure_grid enclosed;  ///< The cubes that the flood did not reach; empty if there was none.
  cap_report caps;
  std::uint32_t welded = 0;      ///< Vertices that were merged into an earlier one, or that no triangle used.
  std::uint32_t degenerate = 0;  ///< Triangles without area. Kept.
  std::uint32_t duplicate = 0;   ///< Triangles that lie on earlier ones. Kept.
  std::uint32_t sheets = 0;      ///< Bodies that enclose nothing.
  std::uint32_t flipped = 0;     ///< Triangles that were turned to agree with their neighbours.
  double one_sided_area = 0;     ///< Area of bodies with only one side, such as a Moebius strip. Square metres.
  double area = 0;               ///< Of all loaded triangles.
};

/// Throws std::invalid_argument if the members of a mesh that close_mesh did not make contradict one another.
void check(const closed_mesh& mesh);

/// Closes a mesh such as robots come with: open, badly oriented, not manifold, made of several shells. Each connected
/// body of each shape is closed separately; a point is inside if it is in any of them. Nothing is dropped; what was
/// found is counted. Throws std::invalid_argument if this is no mesh at all: no triangles, an index out of range, a
/// coordinate that is not finite or beyond 1e15, no triangle with an area, or shapes that are not all triangles in
/// their order. Compiled: link clearance::solid.
closed_mesh close_mesh(const triangle_mesh& mesh, const close_options& options = {});

}  // namespace clearance
