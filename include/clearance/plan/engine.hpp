// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Asks about many configurations on one backend, frame after frame.

#include <clearance/frames/readable.hpp>
#include <clearance/plan/configurations.hpp>
#include <clearance/plan/host_batch.hpp>
#include <clearance/robot/widened.hpp>

namespace clearance::plan {

/// For a backend without a search of its own: each configuration by itself.
template <class On, class PartView, class Q>
class engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : on_(on), model_(model), widened_(on, model, from...) {}

  template <class Clouds>
  typename Q::result run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    typename Q::result all;
    const std::size_t count = detail::count_configurations(model_.size(), poses.size());
    Q::take_counts(all, {}, model_.size());
    Q::results(all).resize(count * (Q::each_part ? model_.size() : 1));
    const auto robot = widened_(q.radii);
    detail::named(model_.size(), poses, [&] {
      for (std::size_t c = 0; c < count; ++c)
        q.ask_one(on_, robot, poses.subspan(c * model_.size(), model_.size()), clouds, all, c);
    });
    return all;
  }
  /// Throws std::invalid_argument as joint_chain::count, too.
  template <class Clouds>
  typename Q::result run_chain(const joint_chain<host>& chain, std::span<const double> joints, const Clouds& clouds,
                               const Q& q) {
    detail::check_chain(model_.size(), chain.parts());
    return run(chain.poses(joints), clouds, q);
  }
  void forget() const {}

 private:
  On on_;
  model_view<PartView> model_;
  widened_model<On, PartView> widened_;
};

/// On the CPU. The result stays valid until the next call.
template <class PartView, class Q>
class engine<host, PartView, Q> {
 public:
  engine(const host& on, const model_view<PartView>& model) : widened_(on, model), search_(on, model, Q::each_part) {}

  template <class Clouds>
  const typename Q::result& run(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Q& q) {
    auto question = q.checked(search_.parts());
    if constexpr (Q::searched::by_margin) question.vague = any_vague(clouds);
    search_.set_robot(widened_(q.radii));
    auto& results = Q::results(result_);
    results.resize(detail::count_configurations(search_.parts(), poses.size()) * (Q::each_part ? search_.parts() : 1));
    detail::named(search_.parts(), poses,
                  [&] { Q::take_counts(result_, search_(poses, clouds, question, results), search_.parts()); });
    return result_;
  }
  /// Throws std::invalid_argument as joint_chain::count, too.
  template <class Clouds>
  const typename Q::result& run_chain(const joint_chain<host>& chain, std::span<const double> joints,
                                      const Clouds& clouds, const Q& q) {
    detail::check_chain(search_.parts(), chain.parts());
    return run(chain.poses(joints), clouds, q);
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() { search_.forget(); }

 private:
  widened_model<host, PartView> widened_;
  host_batch<PartView, typename Q::searched> search_;
  typename Q::result result_;
};

}  // namespace clearance::plan
