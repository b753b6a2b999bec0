// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What print() says of a result: one line.

#include <clearance/motion_clearance.hpp>
#include <clearance/questions/certain_distance.hpp>
#include <clearance/questions/distances.hpp>
#include <clearance/questions/distances_per_part.hpp>
#include <clearance/questions/in_collision.hpp>
#include <clearance/questions/in_collisions.hpp>
#include <clearance/questions/min_distance_supported.hpp>
#include <clearance/questions/min_distances.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/nearest_k.hpp>
#include <clearance/questions/self_filter.hpp>
#include <clearance/questions/within.hpp>
#include <clearance/questions/zones.hpp>
#include <clearance/seen_and_unseen.hpp>
#include <clearance/self_distance.hpp>

#include <memory>
#include <string>
#include <vector>

using part_names = std::shared_ptr<const std::vector<std::string>>;

/// "free: 0.164 m (certainly 0.160 to 0.164), hand to point 84,612"
std::string sentence_of(const clearance::min_distance_result& r, const part_names& names);
std::string sentence_of(const clearance::min_distance_per_part_result& r, const part_names& names);
std::string sentence_of(const clearance::min_distances_result& r, const part_names& names);
std::string sentence_of(const clearance::min_distances_per_part_result& r, const part_names& names);
std::string sentence_of(const clearance::certain_distance_result& r, const part_names& names);
std::string sentence_of(const clearance::collision_result& r, const part_names& names);
std::string sentence_of(const clearance::in_collisions_result& r, const part_names& names);
std::string sentence_of(const clearance::supported_distance& r, const part_names& names);
std::string sentence_of(const clearance::unseen_result& r, const part_names& names);
std::string sentence_of(const clearance::seen_and_unseen_result& r, const part_names& names);
std::string sentence_of(const clearance::motion_clearance_result& r, const part_names& names);
std::string sentence_of(const clearance::zones_result& r, const part_names& names);
std::string sentence_of(const clearance::within_result& r, const part_names& names);
std::string sentence_of(const clearance::nearest_k_result& r, const part_names& names);
std::string sentence_of(const clearance::point_distances& r, const part_names& names);
std::string sentence_of(const clearance::part_distances& r, const part_names& names);
std::string sentence_of(const clearance::self_filter_result& r, const part_names& names);
std::string sentence_of(const clearance::self_clearance& r, const part_names& names);
std::string sentence_of(const clearance::point_counts& r, const part_names& names);
