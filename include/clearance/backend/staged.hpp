// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/concepts.hpp>

namespace clearance {

/// A copy for one call where `on` runs. It does not wait.
template <backend On, class T>
auto staged(const On& on, const std::vector<T>& data) {
  auto there = on.template make_scratch<T>(data.size());
  on.stage(std::span<const T>(data), there.data());
  return there;
}

}  // namespace clearance
