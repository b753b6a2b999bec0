// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Arrays that grow while packing goes on, in the memory of any backend.

#include <clearance/concepts.hpp>

#include <algorithm>

namespace clearance {

namespace detail {

template <class T>
struct copy_items {
  const T* from;
  T* to;
  CLEARANCE_HD void operator()(std::size_t i) const { to[i] = from[i]; }
};

}  // namespace detail

/// An array in B's memory that can grow; its contents are copied in stream order.
template <class T, backend B>
class growing {
 public:
  explicit growing(const B& on) : on_(on), data_(on.template make_scratch<T>(0)) {}

  T* data() { return data_.data(); }
  /// Makes room for `n` elements; the first `kept` keep their values.
  T* reserve(std::size_t n, std::size_t kept = 0) {
    if (n <= data_.size()) return data();
    auto larger = on_.template make_scratch<T>(std::max(n, 2 * data_.size()));
    on_.for_each(kept, detail::copy_items<T>{data(), larger.data()});
    data_ = std::move(larger);
    return data();
  }

 private:
  B on_;
  typename B::template scratch<T> data_;
};

}  // namespace clearance
