// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Memory that a prepared question keeps from frame to frame. device.cuh has a device's.

#include <clearance/concepts.hpp>

#include <algorithm>
#include <cstring>
#include <ranges>
#include <tuple>
#include <utility>
#include <vector>

namespace clearance::backends {

// Values per part for an answer: a few travel inside it, more lie in memory.

/// A view of values. Up to `Few` values lie in the view itself, so that nothing has to be copied before a kernel
/// starts.
template <class T, std::uint32_t Few>
struct few_values {
  T here[Few] = {};
  const T* there = nullptr;  ///< All values, if they are more than `Few`; else null.

  CLEARANCE_HD T operator[](std::uint32_t i) const { return there == nullptr ? here[i] : there[i]; }
};

/// A view of at most `Few` values, or of a copy in the next room of a question's `memory`.
template <std::uint32_t Few, class T, class Memory>
few_values<T, Few> few_or_kept(const std::vector<T>& values, Memory& memory) {
  few_values<T, Few> view;
  if (values.size() <= Few)
    std::copy(values.begin(), values.end(), view.here);
  else
    view.there = std::get<0>(memory.put(values));
  return view;
}

/// The unit in which memory is counted, so that it is aligned for anything.
struct alignas(16) memory_unit {
  std::byte bytes[16];
};

/// Where memory comes from. This is for any backend but a device.
template <class On>
class memory_of {
 public:
  using piece = typename On::template scratch<memory_unit>;

  explicit memory_of(const On& on) : on_(on) {}

  piece allocate(std::size_t units) const { return on_.template make_scratch<memory_unit>(units); }

 private:
  On on_;
};

/// Rooms for what a question keeps for one frame. The next frame uses the same rooms in the same order. Memory is taken
/// only if a room must be larger than ever.
template <class On>
class kept_memory : memory_of<On> {
 public:
  template <class... Memory>
  explicit kept_memory(const On& on, Memory... memory) : memory_of<On>(on, memory...), on_(on) {}

  /// Frees all rooms. Work that was enqueued before uses them before later work does.
  void begin() { used_ = 0; }

  /// The next room, for n values or more.
  template <class T>
  std::span<T> space(std::size_t n) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= alignof(memory_unit));
    auto& piece = next(units<T>(n));
    return {reinterpret_cast<T*>(piece.data()), piece.size() * sizeof(memory_unit) / sizeof(T)};
  }

  /// The next room, with copies of all `data` one after another. It does not wait.
  template <std::ranges::contiguous_range... Data>
  std::tuple<std::ranges::range_value_t<Data>*...> put(const Data&... data) {
    staging_.resize((units<std::ranges::range_value_t<Data>>(data.size()) + ...));
    memory_unit* const there = space<memory_unit>(staging_.size()).data();
    std::size_t at = 0;
    const auto copy = [&]<class U>(std::span<const U> from) {
      static_assert(std::is_trivially_copyable_v<U> && alignof(U) <= alignof(memory_unit));
      const std::size_t its = std::exchange(at, at + units<U>(from.size()));
      if (!from.empty()) std::memcpy(staging_.data() + its, from.data(), from.size_bytes());
      return reinterpret_cast<U*>(there + its);
    };
    const std::tuple all{
        copy(std::span<const std::ranges::range_value_t<Data>>(data))...};  // braces: from left to right
    on_.stage(std::span<const memory_unit>(staging_), there);
    return all;
  }

 private:
  using piece_type = typename memory_of<On>::piece;

  template <class T>
  static std::size_t units(std::size_t n) {
    return (n * sizeof(T) + sizeof(memory_unit) - 1) / sizeof(memory_unit);
  }
  piece_type& next(std::size_t units) {
    if (used_ == rooms_.size()) {
      rooms_.push_back(this->allocate(units));
    } else if (rooms_[used_].size() < units) {
      outgrown_.push_back(this->allocate(std::max(units, 2 * rooms_[used_].size())));
      std::swap(outgrown_.back(), rooms_[used_]);  // a graph may have captured it
    }
    return rooms_[used_++];
  }

  On on_;
  std::size_t used_ = 0;
  std::vector<piece_type> rooms_, outgrown_;
  std::vector<memory_unit> staging_;
};

}  // namespace clearance::backends
