// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A source of any kind, for programs that learn the kind while they run: a question is compiled once for all of them.

#include <clearance/points/arrays.hpp>
#include <clearance/points/cropped.hpp>
#include <clearance/points/tile.hpp>

#include <cstring>
#include <new>

namespace clearance {

/// A view of any point source, for a host: the source's own view and a table of its functions. A scan calls one for a
/// hundred points, so it is as fast as the source. `uncertain<any_points, ...>` is any uncertain source.
class any_points {
 public:
  using can = clearance::can<sources::read, sources::surveyed, sources::unfiltered, sources::ranged, sources::seen,
                             sources::rounded, sources::slicing>;

  template <point_source S>
    requires(!std::same_as<S, any_points>)
  any_points(const S& source) : of_(&functions_of<S>), size_(source.size()) {
    static_assert(points_alone<S>());
    static_assert(!detail::only_on_device<S>(), "any_points are read by a host, and these are in a device's memory");
    static_assert(sizeof(S) <= sizeof view_ && alignof(S) <= alignof(any_points), "any_points has no room for this");
    std::memcpy(view_, &source, sizeof source);
  }

  std::size_t size() const { return size_; }
  sample operator[](std::size_t i) const { return of_->at(view_, begin_ + i); }
  any_points slice(std::size_t begin, std::size_t end) const {
    any_points piece = *this;
    piece.begin_ += begin;
    piece.size_ = end - begin;
    return piece;
  }

  /// See `point_tile`.
  void read(std::size_t begin, std::size_t count, std::size_t stride, point_tile& to,
            std::uint32_t (&dropped)[drop_reasons]) const {
    of_->read(view_, begin_ + begin, count, stride, to, dropped);
  }
  /// See `surveyed_source`.
  bool survey(std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) const {
    return of_->survey(view_, begin_ + begin, box, dropped);
  }
  /// See `unfiltered_source`.
  bool unfiltered() const { return of_->unfiltered(view_); }
  /// See `beyond_range`, `sensor_of` and `rounding_of`.
  real beyond(std::size_t i, vec3 p) const { return of_->beyond(view_, begin_ + i, p); }
  vec3 sensor() const { return of_->sensor(view_); }
  position_error rounding() const { return of_->rounding(view_); }

 private:
  struct functions {
    sample (*at)(const void*, std::size_t);
    void (*read)(const void*, std::size_t, std::size_t, std::size_t, point_tile&, std::uint32_t (&)[drop_reasons]);
    bool (*survey)(const void*, std::size_t, extent&, std::uint32_t (&)[drop_reasons]);
    bool (*unfiltered)(const void*);
    real (*beyond)(const void*, std::size_t, vec3);
    vec3 (*sensor)(const void*);
    position_error (*rounding)(const void*);
  };
  template <class S>
  static const S& viewed(const void* view) {
    return *std::launder(static_cast<const S*>(view));
  }
  template <class S>
  static constexpr functions functions_of = {
      [](const void* v, std::size_t i) { return viewed<S>(v)[i]; },
      [](const void* v, std::size_t begin, std::size_t count, std::size_t stride, point_tile& to,
         std::uint32_t (&dropped)[drop_reasons]) { to.read(viewed<S>(v), begin, count, stride, dropped); },
      [](const void* v, std::size_t begin, extent& box, std::uint32_t (&dropped)[drop_reasons]) {
        if constexpr (surveyed_source<S>) return viewed<S>(v).survey(begin, box, dropped);
        return false;
      },
      [](const void* v) {
        if constexpr (unfiltered_source<S>) return viewed<S>(v).unfiltered();
        return false;
      },
      [](const void* v, std::size_t i, vec3 p) { return beyond_range(viewed<S>(v), i, p); },
      [](const void* v) { return sensor_of(viewed<S>(v)); },
      [](const void* v) { return rounding_of(viewed<S>(v)); }};

  const functions* of_;
  std::size_t begin_ = 0, size_;
  alignas(16) std::byte view_[112 + sizeof(crop_boxes)] = {};
};

static_assert(surveyed_source<any_points> && unfiltered_source<any_points>);

}  // namespace clearance
