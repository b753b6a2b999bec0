// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The library's query on the host, which also takes clouds whose points are partly hidden: as the any_points that all
// clouds become there, so that nothing is compiled for them again.

#include "asker.hpp"

#include <clearance/backends/host.hpp>

template <class Asker, class On, class Model>
class prepared_on_host final : public clearance::any::prepared<Asker, On, Model> {
  using in_memory = clearance::any::prepared<Asker, On, Model>;
  using Q = typename Asker::question_type;

 public:
  using in_memory::in_memory;

  typename Q::result masked(std::span<const Eigen::Isometry3d> poses, const clouds_about<Q>& clouds,
                            std::span<const clearance::point_label* const> labels, const Q& question) override {
    if constexpr (clearance::lists<Q, clearance::of_images>) {
      return Asker::masked(poses, clouds, labels, question);
    } else {
      return std::move(in_memory::query_)(poses, read_behind(labels, clouds), question);
    }
  }
};
