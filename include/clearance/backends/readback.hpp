// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Brings what a backend wrote to the host, all of it at once. readback.cuh has a device's.

#include <clearance/backends/host.hpp>
#include <clearance/ground/arriving.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <vector>

namespace clearance::backends {

/// An array that a backend wrote, and the vector that takes it. `count`, which lies where the array does, may say that
/// fewer than `size` values were written.
template <class Vector>
struct read_array {
  using value_type = typename Vector::value_type;

  Vector& to;
  const value_type* from;
  std::size_t size;
  const unsigned long long* count = nullptr;

  void take(const value_type* values, std::size_t n) const { to.assign(values, values + n); }
};
template <class Vector, class T>
read_array(Vector&, T*, std::size_t, const unsigned long long* = nullptr) -> read_array<Vector>;

/// Is it read into an `arriving` list?
template <class Read>
inline constexpr bool arrives = false;
template <class T>
inline constexpr bool arrives<read_array<arriving<T>>> = true;

/// One value that a backend wrote, and where it goes.
template <class T>
struct read_value {
  using value_type = T;

  T& to;
  const T* from;
  static constexpr std::size_t size = 1;
  static constexpr const unsigned long long* count = nullptr;

  void take(const T* value, std::size_t) const { to = *value; }
};
template <class T>
read_value(T&, const T*) -> read_value<T>;

/// For any backend but a device.
template <class On>
class readback {
  static_assert(!requires { typename On::own_scan; }, "a device does it otherwise: include backends/readback.cuh");

 public:
  template <class... Memory>
  explicit readback(const On& on, Memory...) : on_(on) {}

  /// For `arriving` lists.
  static std::pmr::memory_resource* memory() { return std::pmr::new_delete_resource(); }

  /// Waits for all that was enqueued, and takes every `read_array` and `read_value`.
  template <class... Reads>
  void operator()(const Reads&... reads) const {
    (read(reads), ...);
  }

 private:
  template <class Read>
  void read(const Read& one) const {
    std::size_t n = one.size;
    const unsigned long long* count = one.count;  // of a value's, which is a constant, nvcc would warn
    if constexpr (std::derived_from<On, host>) {
      if (count != nullptr) n = std::size_t(std::min<unsigned long long>(n, *count));
      one.take(one.from, n);
    } else {
      if (count != nullptr) n = std::size_t(std::min<unsigned long long>(n, on_.copy_out(count, 1)[0]));
      const std::vector<typename Read::value_type> values = on_.copy_out(one.from, n);
      one.take(values.data(), n);
    }
  }

  On on_;
};

}  // namespace clearance::backends
