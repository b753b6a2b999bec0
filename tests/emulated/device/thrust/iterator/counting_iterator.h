// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What the library uses of this header of Thrust.

namespace thrust {

template <class T>
struct counting_iterator {
  T first;
  explicit counting_iterator(T first) : first(first) {}
  T operator[](long long i) const { return T(first + i); }
};

}  // namespace thrust
