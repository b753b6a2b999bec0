// SPDX-License-Identifier: BSD-3-Clause
// COLLADA as robot descriptions use it. Anything not understood that would change the shape (skins, morphs, splines,
// other files) is refused by name. Anything without shape (materials, lights, cameras, physics, animations) is skipped.

#include "io/dae_mesh.hpp"
#include "io/mesh_formats.hpp"
#include "io/mesh_scene.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace clearance::io {

namespace {

class dae_reader {
 public:
  dae_reader(const xml_element& root, const std::string& file, const mesh_limits& limits,
             std::vector<std::string>& notes)
      : root_{root, file, ""}, notes_(notes), scene_(file, limits) {}

  polygon_mesh read() {
    if (root_.element.name != "COLLADA") root_.refuse("begins the file, which is not a COLLADA file");
    root_.only({"version", "xmlns", "base"}, {"asset",
                                              "library_animations",
                                              "library_animation_clips",
                                              "library_cameras",
                                              "library_controllers",
                                              "library_effects",
                                              "library_force_fields",
                                              "library_formulas",
                                              "library_geometries",
                                              "library_images",
                                              "library_joints",
                                              "library_kinematics_models",
                                              "library_kinematics_scenes",
                                              "library_articulated_systems",
                                              "library_lights",
                                              "library_materials",
                                              "library_nodes",
                                              "library_physics_materials",
                                              "library_physics_models",
                                              "library_physics_scenes",
                                              "library_visual_scenes",
                                              "scene",
                                              "extra"});

    index_libraries();
    const xml_place visual = visual_scene();
    const double metre = unit(root_, 1);
    const std::string axis = up(root_, "Y_UP");
    const Eigen::Affine3d metres(Eigen::Scaling(metre));

    for (const auto& library : root_.element.children)
      if (library.name == "library_geometries" || library.name == "library_nodes" ||
          library.name == "library_visual_scenes")
        check_assets(root_.in(library), metre, axis);
    for (const xml_element* node : dae_children(visual.element, "node")) walk(visual.in(*node), metres, 1);
    for (const auto& [geometry, mesh] : meshes_)
      if (!mesh) root_.in(*geometry).refuse("has no place in the scene, so it would be lost");
    if (commas_) note_once(notes_, "has a <unit> with a decimal comma, which is read as a point");
    return scene_.finish();
  }

 private:
  /// Notes what can be referred to.
  void index_libraries() {
    for (const auto& library : root_.element.children) {
      const auto each = [&](const char* name, const char* item, auto act) {
        if (library.name != name) return;
        root_.in(library).only({"id", "name"}, {"asset", item, "extra"});
        for (const xml_element* found : dae_children(library, item)) act(*found);
      };
      each("library_geometries", "geometry", [&](const xml_element& g) {
        geometries_.add(g);
        meshes_.emplace(&g, std::nullopt);
      });
      each("library_visual_scenes", "visual_scene", [&](const xml_element& scene) {
        scenes_.add(scene);
        for (const xml_element* node : dae_children(scene, "node")) add_node(*node);
      });
      each("library_nodes", "node", [&](const xml_element& node) { add_node(node); });
    }
  }

  /// The scene that is shown.
  xml_place visual_scene() const {
    const xml_element* shown = root_.child("scene");
    if (!shown) root_.refuse("has no <scene>, so nothing in it has a place");
    root_.in(*shown).only({},
                          {"instance_visual_scene", "instance_physics_scene", "instance_kinematics_scene", "extra"});
    const xml_element* instance = root_.in(*shown).child("instance_visual_scene");
    if (!instance) root_.in(*shown).refuse("has no visual scene");
    const xml_place visual = root_.in(scenes_.find(root_.in(*instance), "url"));
    visual.only({"id", "name"}, {"asset", "node", "evaluate_scene", "extra"});
    return visual;
  }

  /// The unit in an element's <asset>, in metres.
  double unit(const xml_place& of, double otherwise) {
    const xml_element* asset = of.child("asset");
    if (!asset) return otherwise;
    of.in(*asset).only({}, {"contributor", "coverage", "created", "keywords", "modified", "revision", "subject",
                            "title", "unit", "up_axis", "extra"});
    const xml_element* unit = of.in(*asset).child("unit");
    if (!unit) return otherwise;
    of.in(*unit).only({"meter", "name"}, {});
    if (const std::string* spelt = unit->attribute("meter"))
      if (const auto metres = with_decimal_comma(*spelt)) {
        commas_ = true;
        return *metres;
      }
    const double metres = of.in(*unit).number_or("meter", 1);
    if (!(metres > 0)) of.in(*unit).refuse("of " + std::to_string(metres) + " metres is no length");
    return metres;
  }

  /// The up axis in an element's <asset>.
  static std::string up(const xml_place& of, const std::string& otherwise) {
    const xml_element* asset = of.child("asset");
    const xml_element* axis = asset ? of.in(*asset).child("up_axis") : nullptr;
    if (!axis) return otherwise;
    std::string_view rest = axis->text;
    return std::string(take_word(rest, " \t\r\n"));
  }

  /// Refuses a unit or up axis for only a part of the file: other readers apply the file's own to everything.
  void check_assets(const xml_place& of, double metres, const std::string& axis) {
    if (const double own = unit(of, metres); own != metres)
      of.refuse("has a unit of " + spelt(own) + " m of its own, the file's is " + spelt(metres) + " m");
    if (const std::string own = up(of, axis); own != axis)
      of.refuse("has an up axis " + io::quoted(own) + " of its own, the file's is " + io::quoted(axis));
    for (const auto& child : of.element.children) check_assets(of.in(child), metres, axis);
  }

  /// The number above 0 that "0,01" means. None for "1,000", which may be a thousand.
  static std::optional<double> with_decimal_comma(std::string text) {
    const std::size_t comma = text.find(',');
    if (comma == text.npos || comma == 0 || text.find('.') != text.npos || text.find(',', comma + 1) != text.npos)
      return std::nullopt;
    if (text.size() - comma == 4 && text[0] != '0') return std::nullopt;
    text[comma] = '.';
    const auto metres = number<double>(text);
    return metres && *metres > 0 && std::isfinite(*metres) ? metres : std::nullopt;
  }

  static std::string spelt(double metres) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", metres);
    return text;
  }

  void add_node(const xml_element& node) {
    nodes_.add(node);
    for (const xml_element* below : dae_children(node, "node")) add_node(*below);
  }

  template <std::size_t N>
  static std::array<double, N> numbers(const xml_place& at) {
    constexpr std::uint64_t count = N;
    const auto all = dae_numbers<double>(at, &count);
    std::array<double, N> made;
    std::ranges::copy(all, made.begin());
    for (const double x : made)
      if (!std::isfinite(x)) at.refuse("has a number that is not finite");
    return made;
  }

  static Eigen::Affine3d transform(const xml_place& at) {
    const std::string& kind = at.element.name;
    Eigen::Affine3d made = Eigen::Affine3d::Identity();
    if (kind == "matrix") {
      const auto m = numbers<16>(at);
      for (int i = 0; i < 16; ++i) made.matrix()(i / 4, i % 4) = m[std::size_t(i)];
      if (made.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1)) at.refuse("does not end in 0 0 0 1");
    } else if (kind == "translate") {
      const auto v = numbers<3>(at);
      made.translate(Eigen::Vector3d(v[0], v[1], v[2]));
    } else if (kind == "scale") {
      const auto v = numbers<3>(at);
      made.scale(Eigen::Vector3d(v[0], v[1], v[2]));
    } else if (kind == "rotate") {
      const auto v = numbers<4>(at);
      const Eigen::Vector3d axis(v[0], v[1], v[2]);
      if (v[3] != 0 && !(axis.norm() > 0)) at.refuse("has an axis without direction");
      if (v[3] != 0) made.rotate(Eigen::AngleAxisd(v[3] * std::numbers::pi / 180, axis.normalized()));
    }
    return made;
  }

  void walk(const xml_place& node, Eigen::Affine3d here, std::size_t depth) {
    scene_.visit(depth);
    scene_.look_at(node.element.children.size() + node.element.attributes.size());
    node.only({"id", "name", "sid", "type", "layer"},
              {"asset", "matrix", "rotate", "scale", "translate", "node", "instance_node", "instance_geometry",
               "instance_camera", "instance_light", "extra"});
    for (const auto& child : node.element.children) here = here * transform(node.in(child));
    for (const auto& child : node.element.children) {
      const auto at = node.in(child);
      if (child.name == "node") walk(at, here, depth + 1);
      if (child.name == "instance_node") {
        at.only({"url", "sid", "name", "proxy"}, {"extra"});
        walk(node.in(nodes_.find(at, "url")), here, depth + 1);
      }
      if (child.name == "instance_geometry") {
        at.only({"url", "sid", "name"}, {"bind_material", "extra"});
        const xml_element& found = geometries_.find(at, "url");
        std::optional<polygon_mesh>& mesh = meshes_[&found];
        if (!mesh) mesh = dae_geometry(root_.in(found), notes_);
        scene_.place(*mesh, here);
      }
    }
  }

  const xml_place root_;
  std::vector<std::string>& notes_;
  mesh_scene scene_;
  dae_ids geometries_, scenes_, nodes_;
  std::map<const xml_element*, std::optional<polygon_mesh>> meshes_;  // by geometry, once one is placed
  bool commas_ = false;                                               // a unit has a decimal comma
};

}  // namespace

polygon_mesh read_dae(std::string_view bytes, const std::string& file, const mesh_limits& limits,
                      std::vector<std::string>& notes) {
  const xml_element root = read_xml(bytes, file, limits);
  return dae_reader(root, file, limits, notes).read();
}

}  // namespace clearance::io
