// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the parts of a robot were given to find sooner what is near: fields, cells, both, or neither. No answer depends
// on it.

#include <clearance/robot/cells.hpp>
#include <clearance/robot/field.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace clearance {

/// Owns the near maps of a robot's parts, in the memory of one backend.
template <class B = host>
class near_maps {
  static_assert(backend<B>);

 public:
  near_maps() = default;
  /// A copy has views of its own maps.
  near_maps(const near_maps& other)
    requires std::copy_constructible<field<B>>
      : fields_(other.fields_),
        cells_(other.cells_),
        field_views_(views_of(fields_, B{})),
        cells_views_(views_of(cells_, B{})) {}
  near_maps(near_maps&&) = default;
  near_maps& operator=(near_maps&&) = default;

  /// One per part, or none.
  const std::vector<field<B>>& fields() const { return fields_; }
  const std::vector<clearance::cells<B>>& cells() const { return cells_; }
  /// One per part, or null.
  const field_view* field_views() const { return fields_.empty() ? nullptr : field_views_.data(); }
  const cells_view* cells_views() const { return cells_.empty() ? nullptr : cells_views_.data(); }

  /// If one part's field is empty, none is used. Throws std::invalid_argument if one was made for another part.
  void set_fields(std::vector<field<B>> fields, std::span<const part_facts> parts, const B& on) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      const field<B>& its = fields[k];
      if (!its.empty() && !(is_around(its.shape.around, parts, k) && its.cells.size() == its.shape.all_cubes()))
        throw std::invalid_argument("clearance: field " + std::to_string(k) + " is not that of part " +
                                    std::to_string(k));
    }
    if (fields.size() != parts.size() || std::ranges::any_of(fields, &field<B>::empty)) fields.clear();
    field_views_ = views_of(fields, on);
    fields_ = std::move(fields);
  }
  /// A part whose cells are empty has none. Throws std::invalid_argument if some were made for another part.
  void set_cells(std::vector<clearance::cells<B>> cells, std::span<const part_facts> parts, const B& on) {
    for (std::size_t k = 0; k < cells.size(); ++k)
      if (!cells[k].empty() && !is_around(cells[k].around, parts, k))
        throw std::invalid_argument("clearance: cells " + std::to_string(k) + " are not those of part " +
                                    std::to_string(k));
    const bool none = std::ranges::all_of(cells, &clearance::cells<B>::empty);
    cells.resize(none ? 0 : parts.size());
    cells_views_ = views_of(cells, on);
    cells_ = std::move(cells);
  }

 private:
  static bool is_around(const ball& its, std::span<const part_facts> parts, std::size_t k) {
    return k < parts.size() && its.center == parts[k].center && its.radius == parts[k].radius;
  }
  template <class Map>
  static auto views_of(const std::vector<Map>& maps, const B& on) {
    using view_type = decltype(maps[0].view());
    std::vector<view_type> views;
    for (const Map& its : maps) views.push_back(its.view());
    return on.copy_in(std::span<const view_type>(views));
  }

  std::vector<field<B>> fields_;
  std::vector<clearance::cells<B>> cells_;
  typename B::template buffer<field_view> field_views_ = {};
  typename B::template buffer<cells_view> cells_views_ = {};
};

}  // namespace clearance
