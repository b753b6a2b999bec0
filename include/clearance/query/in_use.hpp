// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A prepared object used twice at once, which debug builds refuse.

#include <atomic>
#include <stdexcept>

namespace clearance::detail {

/// Is a prepared object being asked? Copies are other objects. It has a size in release builds, too, so that both kinds
/// of build agree about objects that they share.
class in_use {
 public:
  in_use() = default;
  in_use(const in_use&) noexcept {}
  in_use& operator=(const in_use&) noexcept { return *this; }

  /// One call.
  class [[nodiscard]] call {
   public:
    /// Without NDEBUG: throws std::logic_error if another call has not returned.
    explicit call([[maybe_unused]] in_use& object) {
#if !defined(NDEBUG)
      if (object.now_.exchange(true, std::memory_order_acquire))
        throw std::logic_error(
            "clearance: a prepared question is asked while it is being asked; give each thread its own");
      object_ = &object;
#endif
    }
    call(const call&) = delete;
    call& operator=(const call&) = delete;
    ~call() {
#if !defined(NDEBUG)
      object_->now_.store(false, std::memory_order_release);
#endif
    }

#if !defined(NDEBUG)
   private:
    in_use* object_;
#endif
  };

 private:
  std::atomic<bool> now_ = false;
};

}  // namespace clearance::detail
