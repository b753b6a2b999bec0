// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The <geometry> of a COLLADA file. Every list must have exactly as many numbers as the file says.

#include "io/mesh_polygons.hpp"
#include "io/note_tally.hpp"
#include "io/xml.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearance::io {

/// The numbers in an element's text; exactly `count` of them if it is given.
template <class T>
std::vector<T> dae_numbers(const xml_place& at, const std::uint64_t* count = nullptr) {
  if (!at.element.children.empty()) at.in(at.element.children.front()).refuse("is inside a list of numbers");
  std::vector<T> made;
  std::string_view rest = at.element.text;
  for (auto word = take_word(rest, " \t\r\n"); !word.empty(); word = take_word(rest, " \t\r\n")) {
    const auto value = number<T>(word);
    if (!value) at.refuse("has " + io::quoted(word) + " among its numbers");
    made.push_back(*value);
  }
  if (count && made.size() != *count)
    at.refuse("says that it has " + std::to_string(*count) + " numbers, and has " + std::to_string(made.size()));
  return made;
}

inline std::uint64_t dae_count(const xml_place& at, const char* name) {
  const auto value = number<std::uint64_t>(at.attribute(name));
  if (!value || *value > UINT32_MAX) at.refuse("has the " + std::string(name) + " " + io::quoted(at.attribute(name)));
  return *value;
}
inline std::uint64_t dae_count(const xml_place& at, const char* name, std::uint64_t otherwise) {
  return at.element.attribute(name) ? dae_count(at, name) : otherwise;
}

inline std::vector<const xml_element*> dae_children(const xml_element& of, std::string_view name) {
  std::vector<const xml_element*> made;
  for (const auto& child : of.children)
    if (child.name == name) made.push_back(&child);
  return made;
}

/// Elements by their ids.
class dae_ids {
 public:
  void add(const xml_element& element) {
    if (const std::string* id = element.attribute("id"))
      if (const auto [at, is_new] = by_id_.emplace(*id, &element); !is_new) at->second = nullptr;
  }
  dae_ids() = default;
  explicit dae_ids(const std::vector<const xml_element*>& elements) {
    for (const xml_element* each : elements) add(*each);
  }

  /// The element that the attribute refers to ("#id"); none, or more than one, is an error.
  const xml_element& find(const xml_place& from, std::string_view attribute) const {
    const std::string& url = from.attribute(attribute);
    if (!url.starts_with('#')) from.refuse("names " + io::quoted(url) + ", which is not in this file");
    const auto found = by_id_.find(std::string_view(url).substr(1));
    if (found == by_id_.end()) from.refuse("names " + io::quoted(url) + ", which does not exist");
    if (!found->second) from.refuse("names " + io::quoted(url) + ", of which there are two");
    return *found->second;
  }

 private:
  std::map<std::string, const xml_element*, std::less<>> by_id_;  // null: two elements have this id
};

/// The positions of a <mesh>: those that its <vertices> refer to. Some exporters count an array's floats, which is
/// taken for what is meant, with a note; every index is checked against the positions that are there.
inline std::vector<Eigen::Vector3d> dae_positions(const xml_place& mesh, const xml_place& vertices,
                                                  std::vector<std::string>& notes) {
  vertices.only({"id", "name"}, {"input", "extra"});
  const xml_element* input = nullptr;
  for (const xml_element* each : dae_children(vertices.element, "input"))
    if (vertices.in(*each).attribute("semantic") == "POSITION")
      if (std::exchange(input, each)) vertices.refuse("has two inputs for positions");
  if (!input) vertices.refuse("has no input for positions");
  const auto at = vertices.in(*input);
  const auto source = mesh.in(dae_ids(dae_children(mesh.element, "source")).find(at, "source"));
  source.only({"id", "name"}, {"asset", "float_array", "technique_common", "technique"});
  const xml_element* technique = source.child("technique_common");
  const xml_element* accessor = technique ? source.in(*technique).child("accessor") : nullptr;
  if (!accessor) source.refuse("has no accessor");
  const auto access = source.in(*accessor);
  access.only({"source", "count", "offset", "stride"}, {"param"});
  const auto array = mesh.in(dae_ids(dae_children(source.element, "float_array")).find(access, "source"));

  const std::uint64_t size = dae_count(array, "count");
  std::uint64_t count = dae_count(access, "count");
  const std::uint64_t offset = dae_count(access, "offset", 0), stride = dae_count(access, "stride", 1);
  for (std::size_t i = 0; i < 3; ++i)
    if (accessor->children.size() < 3 || stride < 3 ||
        access.in(accessor->children[i]).attribute("name") != std::string(1, "XYZ"[i]))
      access.refuse("of positions has no params X, Y and Z");

  const auto values = dae_numbers<double>(array, &size);
  if (count == size && size > 3 && offset == 0 && size % stride == 0) {
    count = size / stride;
    note_once(notes, "has an <accessor> that counts floats and not positions, which is taken so");
  }
  if (count > 0 && offset + (count - 1) * stride + 3 > size) access.refuse("needs more values than its array has");

  std::vector<Eigen::Vector3d> made(count);
  for (std::uint64_t i = 0; i < count; ++i)
    for (int k = 0; k < 3; ++k) {
      made[i][k] = values[offset + i * stride + std::uint64_t(k)];
      if (!std::isfinite(made[i][k])) array.refuse("has a coordinate that is not finite");
    }
  return made;
}

/// Where a list holds its vertex indices: every `stride`-th number, from `first` on.
struct dae_indices {
  std::uint64_t stride = 1, first = 0;
};

inline dae_indices dae_layout(const xml_place& list, const std::string& vertices) {
  dae_indices made;
  int found = 0;
  for (const xml_element* input : dae_children(list.element, "input")) {
    const auto at = list.in(*input);
    at.only({"semantic", "source", "offset", "set"}, {});
    const std::uint64_t offset = dae_count(at, "offset");
    if (offset > 100) at.refuse("has an offset above 100");
    made.stride = std::max(made.stride, offset + 1);
    if (at.attribute("semantic") != "VERTEX") continue;
    if (at.attribute("source") != "#" + vertices) at.refuse("names other vertices than its mesh has");
    made.first = offset;
    ++found;
  }
  if (found != 1) list.refuse("has " + std::to_string(found) + " inputs for vertices, not one");
  return made;
}

/// The vertices that a list <p> refers to.
inline std::vector<std::uint32_t> dae_corners(const xml_place& at, const dae_indices& layout, std::size_t vertices) {
  const auto all = dae_numbers<std::int64_t>(at);
  if (all.size() % layout.stride)
    at.refuse("has " + std::to_string(all.size()) + " indices, in groups of " + std::to_string(layout.stride));
  std::vector<std::uint32_t> corners;
  for (std::size_t i = layout.first; i < all.size(); i += layout.stride) {
    if (all[i] < 0 || std::uint64_t(all[i]) >= vertices)
      at.refuse("has the vertex " + std::to_string(all[i]) + ", and the mesh has " + std::to_string(vertices));
    corners.push_back(std::uint32_t(all[i]));
  }
  return corners;
}

/// Adds the triangles of a strip, or of a fan.
inline void dae_strip(const xml_place& at, bool fan, const std::vector<std::uint32_t>& corners, polygon_mesh& mesh) {
  if (corners.size() < 3) at.refuse("has fewer than three corners");
  for (std::size_t i = 2; i < corners.size(); ++i) {
    if (fan)
      mesh.corners.insert(mesh.corners.end(), {corners[0], corners[i - 1], corners[i]});
    else
      mesh.corners.insert(mesh.corners.end(), {corners[i - 2 + i % 2], corners[i - 1 - i % 2], corners[i]});
    mesh.ends.push_back(mesh.corners.size());
  }
}

/// Adds faces with these numbers of corners; together they must use all corners.
inline void dae_polygons(const xml_place& at, const std::vector<std::uint64_t>& sizes,
                         const std::vector<std::uint32_t>& corners, polygon_mesh& mesh) {
  std::uint64_t taken = 0;
  for (const std::uint64_t size : sizes) {
    if (size < 3) at.refuse("belongs to a face of fewer than three corners");
    if (size > corners.size() - taken) at.refuse("has fewer corners than its faces need");
    const auto first = corners.begin() + std::ptrdiff_t(taken);
    mesh.corners.insert(mesh.corners.end(), first, first + std::ptrdiff_t(size));
    mesh.ends.push_back(mesh.corners.size());
    taken += size;
  }
  if (taken != corners.size()) at.refuse("has more corners than its faces need");
}

/// Adds the faces of one list of primitives.
inline void dae_faces(const xml_place& list, const std::string& vertices, polygon_mesh& mesh) {
  const std::string& kind = list.element.name;
  list.only({"name", "count", "material"}, {"input", "p", "vcount", "extra"});
  const dae_indices layout = dae_layout(list, vertices);
  const std::uint64_t count = dae_count(list, "count");
  const auto lists = dae_children(list.element, "p");
  const bool one = kind == "triangles" || kind == "polylist";
  if (lists.size() != (one ? 1 : count) && !(one && lists.empty() && count == 0))
    list.refuse("has the count " + std::to_string(count) + " and " + std::to_string(lists.size()) + " lists <p>");

  std::vector<std::uint64_t> sizes;  // corners of each face
  if (const xml_element* counts = list.child("vcount"); kind == "polylist") {
    if (!counts && count > 0) list.refuse("has no <vcount>");
    if (counts) sizes = dae_numbers<std::uint64_t>(list.in(*counts), &count);
  } else if (counts) {
    list.in(*counts).refuse("is not known in <" + kind + ">");
  }

  for (const xml_element* each : lists) {
    const auto at = list.in(*each);
    const auto corners = dae_corners(at, layout, mesh.vertices.size());
    if (kind == "tristrips" || kind == "trifans") {
      dae_strip(at, kind == "trifans", corners, mesh);
      continue;
    }
    if (kind == "triangles" && corners.size() != 3 * count)
      at.refuse("has " + std::to_string(corners.size()) + " corners, and its list says " + std::to_string(count) +
                " triangles");
    if (kind == "triangles") sizes.assign(corners.size() / 3, 3);
    if (kind == "polygons") sizes.assign(1, corners.size());
    dae_polygons(at, sizes, corners, mesh);
  }
}

/// The faces of a <geometry>; lines have no surface and are skipped.
inline polygon_mesh dae_geometry(const xml_place& geometry, std::vector<std::string>& notes) {
  geometry.only({"id", "name"}, {"asset", "mesh", "extra"});
  const xml_element* element = geometry.child("mesh");
  if (!element) geometry.refuse("has no mesh");
  const auto mesh = geometry.in(*element);
  mesh.only({}, {"source", "vertices", "triangles", "polylist", "polygons", "tristrips", "trifans", "lines",
                 "linestrips", "extra"});
  const auto vertices = dae_children(*element, "vertices");
  if (vertices.size() != 1) mesh.refuse(vertices.empty() ? "has no vertices" : "has more than one <vertices>");
  const std::string& id = mesh.in(*vertices.front()).attribute("id");
  polygon_mesh made;
  made.vertices = dae_positions(mesh, mesh.in(*vertices.front()), notes);
  for (const auto& child : element->children)
    if (child.name == "triangles" || child.name == "polylist" || child.name == "polygons" ||
        child.name == "tristrips" || child.name == "trifans")
      dae_faces(mesh.in(child), id, made);
  return made;
}

}  // namespace clearance::io
