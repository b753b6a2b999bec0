// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Everything that a plain C++ compiler takes, but for io/, which needs libraries of its own. For the impatient: a program
// that includes only what it uses compiles faster.

#include <clearance/bvh/build.hpp>
#include <clearance/bvh/flat_list.hpp>
#include <clearance/chunked_query.hpp>
#include <clearance/collect.hpp>
#include <clearance/distances.hpp>
#include <clearance/distances_per_part.hpp>
#include <clearance/distances_query.hpp>
#include <clearance/gradient.hpp>
#include <clearance/in_collision.hpp>
#include <clearance/in_collisions.hpp>
#include <clearance/make_model.hpp>
#include <clearance/min_distance.hpp>
#include <clearance/min_distance_by.hpp>
#include <clearance/min_distance_query.hpp>
#include <clearance/min_distances.hpp>
#include <clearance/min_support.hpp>
#include <clearance/motion_clearance.hpp>
#include <clearance/nearest_k.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/part_witnesses.hpp>
#include <clearance/points/depth_image.hpp>
#include <clearance/points/point_span.hpp>
#include <clearance/points/ray_image.hpp>
#include <clearance/points/strided_points.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/primitive/triangle.hpp>
#include <clearance/robot/attached.hpp>
#include <clearance/robot/model.hpp>
#include <clearance/self_filter.hpp>
#include <clearance/separation.hpp>
#include <clearance/signed_distances.hpp>
#include <clearance/solid/implicit.hpp>
#include <clearance/solid/mesh_solid.hpp>
#include <clearance/traversal/near_first.hpp>
#include <clearance/traversal/recursive.hpp>
#include <clearance/traversal/stack.hpp>
#include <clearance/visitor/any_within.hpp>
#include <clearance/visitor/nearest.hpp>
#include <clearance/volume/aabb.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>
#include <clearance/within.hpp>
#include <clearance/zones.hpp>
