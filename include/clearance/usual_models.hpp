// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// The fastest trees for each model of a robot: for whoever does not choose a volume.

#include <clearance/make_model.hpp>
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/obb.hpp>
#include <clearance/volume/sphere.hpp>

namespace clearance {

/// A robot of inner spheres, in memory of the backend `B`.
template <class B = host>
using sphere_model = model<part<bvh<sphere, inner_sphere, B>>, B>;

/// A robot of triangles that knows its inside.
template <class B = host>
using triangle_model = model<part<bvh<obb, triangle, B>, winding<B>>, B>;

}  // namespace clearance
