// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Long lists of an answer, in memory that a backend brings them to.

#include <algorithm>
#include <cstddef>
#include <memory_resource>
#include <new>
#include <utility>
#include <vector>

namespace clearance {

/// Takes memory from a resource, and leaves values as they are until they arrive: a list of millions is not set to 0
/// first. A copy of a list takes its memory from the heap.
template <class T>
class arrival_allocator {
 public:
  using value_type = T;
  using propagate_on_container_move_assignment = std::true_type;
  using propagate_on_container_swap = std::true_type;

  arrival_allocator(std::pmr::memory_resource* from = std::pmr::new_delete_resource()) noexcept : from_(from) {}
  template <class U>
  arrival_allocator(const arrival_allocator<U>& other) noexcept : from_(other.resource()) {}

  T* allocate(std::size_t n) { return static_cast<T*>(from_->allocate(n * sizeof(T), alignof(T))); }
  void deallocate(T* data, std::size_t n) { from_->deallocate(data, n * sizeof(T), alignof(T)); }
  template <class U>
  void construct(U* at) {
    ::new (static_cast<void*>(at)) U;
  }
  template <class U, class... A>
  void construct(U* at, A&&... of) {
    ::new (static_cast<void*>(at)) U(std::forward<A>(of)...);
  }
  arrival_allocator select_on_container_copy_construction() const { return {}; }

  std::pmr::memory_resource* resource() const { return from_; }
  template <class U>
  bool operator==(const arrival_allocator<U>& other) const {
    return from_ == other.resource();
  }

 private:
  std::pmr::memory_resource* from_;
};

/// A std::vector in such memory. What a device answers lies in pinned memory, where it arrived: nothing copies it
/// again.
template <class T>
struct arriving : std::vector<T, arrival_allocator<T>> {
  using list = std::vector<T, arrival_allocator<T>>;
  using list::list;
  arriving(const std::vector<T>& other) : list(other.begin(), other.end()) {}

  operator std::vector<T>() const { return {this->begin(), this->end()}; }
  friend bool operator==(const arriving& a, const arriving& b) { return std::ranges::equal(a, b); }
  friend bool operator==(const arriving& a, const std::vector<T>& b) { return std::ranges::equal(a, b); }
};

}  // namespace clearance
