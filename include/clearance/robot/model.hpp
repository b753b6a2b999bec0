// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot as every question takes it: its parts, in the memory of one backend.

#include <clearance/ground/borrowed.hpp>
#include <clearance/robot/near_maps.hpp>

#include <algorithm>
#include <concepts>
#include <stdexcept>
#include <utility>

namespace clearance {

/// What an operation takes as a robot: part views in the memory of a backend, and their facts on the host. To use trees
/// of your own, fill it in yourself. The facts must be those of the part views; they are checked as a model's.
template <class PartView>
struct model_view {
  using part_type = PartView;

  const PartView* parts;
  borrowed<part_facts> facts;
  std::uint32_t depth, width;          ///< The largest over all trees.
  const field_view* fields = nullptr;  ///< One per part, or null.
  const cells_view* cells = nullptr;   ///< The same.

  std::size_t size() const { return facts.size(); }
  /// A robot of part k alone.
  model_view part(std::size_t k) const {
    return {parts + k,
            facts.subspan(k, 1),
            depth,
            width,
            fields == nullptr ? nullptr : fields + k,
            cells == nullptr ? nullptr : cells + k};
  }
};

/// Throws std::invalid_argument if a part's facts are invalid. Every view that no model has checked comes here.
template <class PartView>
void check(const model_view<PartView>& view) {
  for (std::size_t k = 0; k < view.size(); ++k) check(view.facts[k], std::int64_t(k));
}

/// A rigid body: what `make_part` makes. It is a robot of one part.
template <class R>
concept rigid_part = requires(const R r) {
  { r.facts } -> std::convertible_to<const part_facts&>;
  r.view().tree;
};

/// What operations take as a robot: a `model` or its view. `view_of` returns the view.
template <class Robot>
concept robot = !rigid_part<Robot> && (requires(const Robot r) {
  { r.facts } -> std::convertible_to<std::span<const part_facts>>;
  r.parts;
} || requires(const Robot r) { r.view().facts; });
template <robot Robot>
auto view_of(const Robot& r) {
  if constexpr (requires { r.view(); }) {
    return r.view();
  } else {
    check(r);
    return r;
  }
}

/// A robot, or a part, that owns what a view of it looks at. Of a temporary one nothing can be made that is asked
/// later.
template <class R>
concept owning_robot = rigid_part<R> || (robot<R> && !std::is_trivially_copyable_v<R>);

namespace detail {

template <class R>
struct part_view_of {
  using type = typename decltype(view_of(std::declval<const R&>()))::part_type;
};
template <rigid_part R>
struct part_view_of<R> {
  using type = std::remove_const_t<decltype(std::declval<const R&>().view())>;
};

}  // namespace detail

/// `robot<R>`, or a part, with reasons.
template <class R>
consteval bool explain_robot() {
  static_assert(robot<R> || rigid_part<R>,
                "a robot is: a model (make_model), its view, or one part. The arguments are: backend, robot, poses, "
                "clouds, question");
  return robot<R> || rigid_part<R>;
}

template <class Model>
class replicas;  // for several backends: robot/replicas.hpp

/// Owns the parts of a robot in the memory of one backend. Parts are numbered as given.
template <class Part, class B = host>
class model {
  static_assert(backend<B>);

 public:
  using part_type = Part;
  using view_type = decltype(std::declval<const Part&>().view());

  /// Throws std::invalid_argument if there is no part, or if a part's facts are invalid.
  explicit model(std::vector<Part> parts, const B& on = {}) : parts_(std::move(parts)) {
    if (parts_.empty()) throw std::invalid_argument("clearance::model: there are no parts");
    std::vector<view_type> views;
    for (const Part& p : parts_) {
      check(p.facts, std::int64_t(facts_.size()));
      views.push_back(p.view());
      facts_.push_back(p.facts);
      depth_ = std::max(depth_, views.back().tree.depth());
      width_ = std::max(width_, views.back().tree.width());
    }
    views_ = on.copy_in(std::span<const view_type>(views));
  }

  /// A copy has views of its own parts.
  model(const model& other)
    requires std::copy_constructible<Part>
      : model(other.parts_) {
    near_ = near_maps<B>(other.near_);
  }
  model(model&&) = default;
  model& operator=(model other) {
    std::swap(parts_, other.parts_);
    std::swap(facts_, other.facts_);
    std::swap(views_, other.views_);
    std::swap(depth_, other.depth_);
    std::swap(width_, other.width_);
    std::swap(near_, other.near_);
    return *this;
  }

  const std::vector<Part>& parts() const { return parts_; }
  std::size_t size() const { return parts_.size(); }
  model_view<view_type> view() const& CLEARANCE_LIFETIMEBOUND {
    return {views_.data(), facts_, depth_, width_, near_.field_views(), near_.cells_views()};
  }
  model_view<view_type> view() const&& = delete;  // the model would be gone when the view is read; give it a name
  /// One per part, or none.
  const std::vector<field<B>>& fields() const { return near_.fields(); }
  const std::vector<clearance::cells<B>>& cells() const { return near_.cells(); }
  /// One field per part, see with_fields. If one is empty, none is used. Throws std::invalid_argument if one was made
  /// for another part.
  void set_fields(std::vector<field<B>> fields, const B& on = {}) { near_.set_fields(std::move(fields), facts_, on); }
  /// Cells of each part, see with_cells; a part of which they are empty has none. Throws as set_fields.
  void set_cells(std::vector<clearance::cells<B>> cells, const B& on = {}) {
    near_.set_cells(std::move(cells), facts_, on);
  }

  /// A copy where `other` runs.
  template <backend Other>
  auto on(const Other& other) const {
    std::vector<decltype(parts_[0].on(other))> copies;
    for (const Part& p : parts_) copies.push_back(p.on(other));
    model<decltype(parts_[0].on(other)), Other> copy(std::move(copies), other);
    if (!fields().empty()) copy.set_fields(copies_of(fields(), other), other);
    if (!cells().empty()) copy.set_cells(copies_of(cells(), other), other);
    return copy;
  }
  /// A copy on each of several backends.
  template <class Several>
    requires requires(const Several several) { several.each(); }
  auto on(const Several& several) const {
    std::vector<decltype(on(several.each()[0]))> copies;
    for (const auto& other : several.each()) copies.push_back(on(other));
    return replicas<decltype(on(several.each()[0]))>(std::move(copies));
  }

 private:
  template <class Map, class Other>
  static auto copies_of(const std::vector<Map>& maps, const Other& other) {
    std::vector<decltype(maps[0].on(other))> copies;
    for (const Map& its : maps) copies.push_back(its.on(other));
    return copies;
  }

  std::vector<Part> parts_;
  std::vector<part_facts> facts_;
  std::uint32_t depth_ = 0, width_ = 0;
  typename B::template buffer<view_type> views_;
  near_maps<B> near_;
};

}  // namespace clearance
