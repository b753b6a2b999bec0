// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Clouds that are loaded one range at a time: they may be larger than a device's memory, or the host's.

#include <clearance/points/arrays.hpp>

#include <stdexcept>
#include <string>
#include <utility>

namespace clearance {

/// A cloud that is loaded in ranges of points. Optional: `static constexpr bool in_place = true` if it is all in
/// memory.
///
/// Law: `load(begin, end, room)` returns points `begin` to `end - 1`, in its own memory or in the `room(end - begin)`
/// bytes that it is given (aligned to 64), or throws and says why. One thread at a time calls it, while others read
/// what was loaded before.
template <class C>
concept loaded_cloud = requires(const C c, std::size_t i, std::byte* memory) {
  { c.size() } -> std::convertible_to<std::size_t>;
  { c.bytes_for(i) } -> std::convertible_to<std::size_t>;
  { c.load(i, i, memory) } -> point_source;
};
template <loaded_cloud C>
using loaded_source = decltype(std::declval<const C&>().load(0, 0, nullptr));

/// A cloud whose points have addresses in host memory before they are loaded, so that many ranges are searched as one.
/// Law: `whole()` is a view of all points, of which the loaded ones may be read.
template <class C>
concept addressed_cloud =
    loaded_cloud<C> && requires(const C c) { requires point_source<std::remove_cvref_t<decltype(c.whole())>>; };

/// A source in memory of any kind: host memory, pinned or not, or a device's. `chunked` makes it from a source or an
/// array of points.
template <point_source S>
struct in_memory {
  static constexpr bool in_place = true, only_on_device = detail::only_on_device<S>();

  S source;

  in_memory(const S& source) : source(source) {}
  template <point_container C>
    requires std::is_same_v<points_in<C>, S>
  in_memory(const C& points CLEARANCE_LIFETIMEBOUND) : source(points_of(points)) {}
  template <owning_points C>
  in_memory(const C&&) = delete;  // the points would be gone before they are read; name them

  std::size_t size() const { return source.size(); }
  std::size_t bytes_for(std::size_t) const { return 0; }
  const S& whole() const { return source; }
  auto load(std::size_t begin, std::size_t end, std::byte*) const { return slice(source, begin, end); }
};

/// Records that your functions read. `read(offset, bytes)` fills `bytes` (a span) with the data that begins `offset`
/// bytes after the first record's start, or throws. `view(memory, count)` is a source over that many records in memory.
/// Throws std::invalid_argument if a record has no bytes, or if the total size overflows.
template <class Read, class View>
struct read_records {
  std::size_t count, record_bytes;
  Read read;
  View view;

  read_records(std::size_t count, std::size_t record_bytes, Read read, View view)
      : count(count), record_bytes(record_bytes), read(std::move(read)), view(std::move(view)) {
    if (record_bytes == 0 || count > ~std::size_t(0) / record_bytes)
      throw std::invalid_argument("clearance: " + std::to_string(count) + " records of " +
                                  std::to_string(record_bytes) + " bytes");
  }

  std::size_t size() const { return count; }
  std::size_t bytes_for(std::size_t points) const { return points * record_bytes; }
  auto load(std::size_t begin, std::size_t end, std::byte* memory) const {
    if (begin != end) read(begin * record_bytes, std::span<std::byte>(memory, (end - begin) * record_bytes));
    return view(static_cast<const std::byte*>(memory), end - begin);
  }
};
}  // namespace clearance
