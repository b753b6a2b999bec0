// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Gives the parts of a robot near maps, by which questions find sooner what is near: fields, cells, or one after the
// other both. The robot stays of its type, and no answer changes.

#include <clearance/concepts.hpp>
#include <clearance/minimum/field_sample.hpp>
#include <clearance/pointwise/cell_tree.hpp>
#include <clearance/robot/model.hpp>

#include <string>
#include <vector>

namespace clearance {

/// A robot whose parts have what was asked for, and for each part that cannot have it a sentence that says why; else it
/// is empty.
template <class Model>
struct equipped {
  Model model;
  std::vector<std::string> without;
};

namespace detail {

/// A robot of which part k has the field `make(part, why_not)`. An empty one has its sentence in `why_not`.
template <class Part, class Make>
equipped<model<Part>> fielded_by(model<Part> robot, Make make) {
  using view = typename model<Part>::view_type;
  static_assert(tangent_primitive<typename view::hierarchy_type::primitive_type>,
                "a field needs primitives with `tangent_at`, see concepts/tangent.hpp");
  std::vector<std::string> without(robot.size());
  std::vector<field<host>> fields;
  for (std::size_t k = 0; k < robot.size(); ++k) fields.push_back(make(robot.parts()[k], without[k]));
  robot.set_fields(std::move(fields));
  return {std::move(robot), std::move(without)};
}

}  // namespace detail

/// Gives each part of a robot in host memory a field of about `bytes`, sampled where `on` runs. Questions about many
/// configurations then need one look where they walked a tree; no answer changes. `model.on(device)` copies fields,
/// too. If one part can have none, none is used. Source: Lipschitz and tangent bounds, minimum/field_sample.hpp.
template <backend B, class Part>
equipped<model<Part>> with_fields(const B& on, model<Part> robot, const field_options& options = {}) {
  return detail::fielded_by(std::move(robot), [&](const Part& part, std::string& why_not) {
    return minimum::sampled_field(on, part, options, why_not);
  });
}

/// Gives each part of a robot in host memory cells of at most `bytes`, made where `on` runs. A device then needs a look
/// and some primitives, where it walked a tree, for the distance of a point to a part; no answer changes.
/// `model.on(device)` copies cells, too. A part that can have none keeps its tree alone. Throws std::invalid_argument
/// for a `reach` that cannot be. Source: pointwise/cell_tree.hpp.
template <backend B, class Part>
equipped<model<Part>> with_cells(const B& on, model<Part> robot, const cell_options& options = {}) {
  static_assert(cored_hierarchy<typename model<Part>::view_type::hierarchy_type>,
                "cells need a tree in arrays, of primitives with core_at, see concepts/tangent.hpp");
  std::vector<std::string> without(robot.size());
  std::vector<cells<host>> all;
  for (std::size_t k = 0; k < robot.size(); ++k)
    all.push_back(pointwise::made_cells(on, robot.parts()[k], options, without[k]));
  robot.set_cells(std::move(all));
  return {std::move(robot), std::move(without)};
}

}  // namespace clearance
