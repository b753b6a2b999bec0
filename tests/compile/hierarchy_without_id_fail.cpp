// SPDX-License-Identifier: BSD-3-Clause
// expected-error: a hierarchy needs: primitive(node_type, std::uint32_t) const and std::uint32_t id(
#include <clearance/primitive/inner_sphere.hpp>
#include <clearance/volume/sphere.hpp>

struct list {
  using node_type = std::uint32_t;
  using volume_type = clearance::sphere;
  using primitive_type = clearance::inner_sphere;
  CLEARANCE_HD node_type root() const { return 0; }
  CLEARANCE_HD bool is_leaf(node_type) const { return true; }
  CLEARANCE_HD std::uint32_t size(node_type) const { return 0; }
  CLEARANCE_HD node_type child(node_type, std::uint32_t) const { return 0; }
  CLEARANCE_HD volume_type volume(node_type) const { return {}; }
  CLEARANCE_HD primitive_type primitive(node_type, std::uint32_t) const { return {}; }
  CLEARANCE_HD std::uint32_t depth() const { return 0; }
  CLEARANCE_HD std::uint32_t width() const { return 0; }
};

static_assert(clearance::explain_hierarchy<list>());
