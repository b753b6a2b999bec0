// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Gives the parts of a robot cells: for every place around a part a list of the primitives that can be nearest there.

#include <clearance/backends/host.hpp>
#include <clearance/equipped.hpp>
#include <clearance/pointwise/cell_tree.hpp>
#include <clearance/robot/model.hpp>

namespace clearance {

namespace detail {

/// Makes the cells of one part; it says why not otherwise.
template <backend B, class Part>
cells<host> made_cells(const B& on, const Part& part, const cell_options& options, std::string& why_not) {
  const part_facts& facts = part.facts;
  if (!(options.reach >= 0 && options.reach < 1e6))
    throw std::invalid_argument("clearance::with_cells: cells reach " + std::to_string(options.reach) +
                                " m, which must be from 0 to 1,000,000");
  constexpr std::uint64_t most = std::uint64_t(1) << 34;  // entries are numbered in 32 bits
  if (options.bytes > most)
    return why_not = std::to_string(options.bytes) + " bytes are too many for cells; they take at most " +
                     std::to_string(most),
           cells<host>{};
  if (!(facts.radius > 0 && facts.radius < 1e6f && length(facts.center) < 1e6f))
    return why_not = "a part without a finite size has no cells", cells<host>{};
  try {
    const auto there = part.on(on);
    return pointwise::cell_tree(on, there.view(), facts, part.tree.primitives.size(), options).make(why_not);
  } catch (const std::exception& error) {
    if (!out_of_memory(on, error)) throw;
    why_not = "there is not enough memory to make its cells";
  }
  return {};
}

}  // namespace detail

/// Gives each part of a robot in host memory cells, made where `on` runs. A device then needs a look and some
/// primitives, where it walked a tree, for the distance of a point to a part; no answer changes. `model.on(device)`
/// copies cells, too. A part that can have none keeps its tree alone. Source: pointwise/cell_tree.hpp.
template <backend B, class Part>
equipped<model<celled<Part>>> with_cells(const B& on, model<Part> robot, const cell_options& options = {}) {
  static_assert(cored_hierarchy<typename model<Part>::view_type::hierarchy_type>,
                "cells need a tree in arrays, of primitives with `core_at`, see concepts/tangent.hpp");
  std::vector<std::string> without(robot.size());
  std::vector<celled<Part>> parts;
  for (std::size_t k = 0; k < robot.size(); ++k) {
    const Part& part = robot.parts()[k];
    parts.push_back({part, detail::made_cells(on, part, options, without[k])});
  }
  model<celled<Part>> made(std::move(parts));
  made.set_fields(robot.fields());
  return {std::move(made), std::move(without)};
}

}  // namespace clearance
