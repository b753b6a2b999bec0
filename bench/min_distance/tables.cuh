// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// A robot whose parts have tables besides their trees.
#include <clearance/device.cuh>
#include <clearance/near_maps.hpp>

namespace bench {

struct tables {
  bool fields = false, cells = false;
};

/// Calls `f` with the model on a device.
template <class Model, class F>
void with_tables(const clearance::device& gpu, Model model, tables its, const F& f) {
  const auto have = [](const std::vector<std::string>& without) {
    for (const auto& why_not : without)
      if (!why_not.empty()) throw std::runtime_error(why_not);
  };
  if (its.fields) {
    auto made = clearance::with_fields(gpu, std::move(model));
    have(made.without), model = std::move(made.model);
  }
  if (its.cells) {
    auto made = clearance::with_cells(gpu, std::move(model));
    have(made.without), model = std::move(made.model);
  }
  f(model.on(gpu));
}

}  // namespace bench
