// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asker.hpp"

#include <clearance/query/query.hpp>

/// The library's query about one kind of trees, which it keeps alive.
template <class Q, class Backend, class Model>
class prepared : public asker<Q> {
 public:
  prepared(const Backend& on, std::shared_ptr<const robot_trees<Backend>> trees, const Model& model, const Q& question)
      : trees_(std::move(trees)), query_(on, model, question) {}

  typename Q::result ask(std::span<const Eigen::Isometry3d> poses, const clouds_about<Q>& clouds,
                         const Q& question) override {
    return query_(poses, clouds, question);
  }

 protected:
  std::shared_ptr<const robot_trees<Backend>> trees_;
  decltype(clearance::query(std::declval<const Backend&>(), std::declval<const Model&>(),
                            std::declval<const Q&>())) query_;
};

/// A question may say about which parts it can be asked.
template <class Q, class PartView>
concept about_some_parts = requires { Q::template about<PartView>; };
template <class Q, class PartView>
consteval bool is_about() {
  if constexpr (about_some_parts<Q, PartView>)
    return Q::template about<PartView>;
  else
    return true;
}

template <template <class, class, class> class Prepared = prepared, class Q, class Backend>
std::unique_ptr<asker<Q>> prepare(const Backend& on, std::shared_ptr<const robot_trees<Backend>> trees,
                                  const Q& question) {
  return std::visit(
      [&]<class Model>(const Model& model) -> std::unique_ptr<asker<Q>> {
        if constexpr (is_about<Q, typename decltype(model.view())::part_type>())
          return std::make_unique<Prepared<Q, Backend, Model>>(on, trees, model, question);
        else
          throw std::invalid_argument("clearance: this question is about robots of triangles (model=\"triangles\")");
      },
      *trees);
}
