// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "asker.hpp"

#include <clearance/points/any_points.hpp>
#include <clearance/query/query.hpp>

/// A host reads clouds of all kinds as one, so that each question is compiled for that one, and for uncertain ones.
class read_as_one {
 public:
  template <class S>
  clearance::any_points operator()(const S& source) const {
    return source;
  }
  template <class S>
  auto operator()(const clearance::uncertain<S, clearance::any_noise>& given) const {
    return given.around_same(clearance::any_points(given.source), given.noise);
  }
};
template <class Q>
auto as_one(const clouds_about<Q>& clouds) {
  using sure = clearance::placed<clearance::any_points>;
  using type = std::conditional_t<std::is_same_v<typename cloud_about<Q>::type, any_cloud>, sure,
                                  std::variant<sure, placed_uncertain<clearance::any_points>>>;
  std::vector<type> all;
  clearance::for_each_cloud(clouds, [&](const auto& source, const Eigen::Isometry3d& pose) {
    all.push_back(clearance::placed{read_as_one{}(source), pose});
  });
  return all;
}

/// The library's query about one kind of trees, which it keeps alive.
template <class Q, class Backend, class Model>
class prepared : public asker<Q> {
 public:
  prepared(const Backend& on, std::shared_ptr<const robot_trees<Backend>> trees, const Model& model, const Q& question)
      : trees_(std::move(trees)), query_(on, model, question) {}

  typename Q::result ask(std::span<const Eigen::Isometry3d> poses, const clouds_about<Q>& clouds,
                         const Q& question) override {
    // A device's kernels are compiled for each kind, and `unseen` asks images.
    if constexpr (std::is_same_v<Backend, clearance::host> && !std::is_same_v<Q, clearance::unseen>)
      return query_(poses, as_one<Q>(clouds), question);
    else
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
