// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// How far is a robot from what cameras see, and from what they do not see?

#include <clearance/backends/beside.hpp>
#include <clearance/frames/mapped_clouds.hpp>
#include <clearance/questions/unseen.hpp>

namespace clearance {

/// As unseen, and as min_distance about the same pixels.
struct seen_and_unseen_result : unseen_result {
  min_distance_result seen;  ///< The least distance to what cameras see. Pixels labelled `own` are dropped as `masked`.
};

/// Asks `min_distance` and `unseen` about one frame of images, on a device at the same time. Refused: as unseen.
/// Images that are `uncertain` have no such minimum: certain_distance is asked about them.
struct seen_and_unseen : unseen {
  using result = seen_and_unseen_result;
  using can = clearance::can<checking, of_images, of_points>;
  template <class On, class PartView>
  class engine;
};

template <class On, class PartView>
class seen_and_unseen::engine {
 public:
  template <class... Memory>
  engine(const On& on, const model_view<PartView>& model, Memory... from)
      : readable_(on, from...),
        memory_(on, from...),
        beside_(on, from...),
        seen_(beside_.on(), model, from...),
        unseen_(on, model, from...) {}

  template <class Clouds>
  void begin(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const seen_and_unseen& q) {
    q.check();
    detail::check_labels(q.labels, clouds);
    const auto& here = readable_(clouds);
    memory_.begin();
    if (q.labels.empty())
      begin_both(poses, here, here, q);
    else
      begin_both(poses, here, masked_clouds(here, std::get<0>(memory_.put(q.labels))), q);
  }
  /// The result stays valid until the next call.
  result& finish() {
    try {
      static_cast<unseen_result&>(result_) = unseen_.finish();
      result_.seen = seen_.finish();
    } catch (...) {
      beside_.wait();  // it may still read the clouds
      throw;
    }
    return result_;
  }
  /// Forgets the last frame. The next one starts cold; its answer is the same.
  void forget() {
    seen_.forget();
    unseen_.forget();
  }

 private:
  template <class Clouds, class Shown>
  void begin_both(std::span<const Eigen::Isometry3d> poses, const Clouds& clouds, const Shown& shown, const unseen& q) {
    beside_.follow();
    try {
      seen_.begin(poses, shown, min_distance{});
      unseen_.begin(poses, clouds, q);
    } catch (...) {
      beside_.wait();  // it may still read the clouds
      throw;
    }
  }

  frames::readable_clouds<On> readable_;
  backends::kept_memory<On> memory_;
  backends::beside<On> beside_;
  minimum::engine<On, PartView, min_distance> seen_;
  unseen::engine<On, PartView> unseen_;
  result result_;
};

}  // namespace clearance
