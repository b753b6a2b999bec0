// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// All questions of the library, by name. A check compares the names with the headers.

#include "combinations/sources.hpp"

#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/collect.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/part_witnesses.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/signed_distances.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/seen_and_unseen.hpp>

namespace combinations {

/// Calls `f.template operator()<Q>(name)` for each question.
template <class F>
void for_each_question_type(const F& f) {
  using namespace clearance;
  f.template operator()<min_distance>("min_distance");
  f.template operator()<min_distance_per_part>("min_distance_per_part");
  f.template operator()<certain_distance>("certain_distance");
  f.template operator()<min_distance_supported>("min_distance_supported");
  f.template operator()<distances>("distances");
  f.template operator()<distances_per_part>("distances_per_part");
  f.template operator()<in_collision>("in_collision");
  f.template operator()<within>("within");
  f.template operator()<nearest_k>("nearest_k");
  f.template operator()<zones>("zones");
  f.template operator()<self_filter>("self_filter");
  f.template operator()<min_distances>("min_distances");
  f.template operator()<min_distances_per_part>("min_distances_per_part");
  f.template operator()<in_collisions>("in_collisions");
  f.template operator()<signed_distances>("signed_distances");
  f.template operator()<part_witnesses>("part_witnesses");
  f.template operator()<unseen>("unseen");
  f.template operator()<seen_and_unseen>("seen_and_unseen");
  f.template operator()<collect<pairwise::listed>>("collect");
}

}  // namespace combinations
