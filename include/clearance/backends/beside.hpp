// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Work that may run beside other work. Only a device does both at once.

namespace clearance::backends {

/// Where work of a backend may run beside its other work. It runs one after the other, except on a device:
/// own_stream.cuh.
template <class On>
class beside {
 public:
  template <class... Memory>
  explicit beside(const On& on, Memory...) : on_(on) {}

  const On& on() const { return on_; }
  /// What comes next may read whatever was enqueued so far.
  void follow() const {}
  void wait() const {}

 private:
  On on_;
};

}  // namespace clearance::backends
