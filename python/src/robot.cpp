// SPDX-License-Identifier: BSD-3-Clause
#include "robot.hpp"

#include "arrays.hpp"
#include "device_array.hpp"
#include "device_entry.hpp"
#include "values.hpp"

#include <clearance/ground/numbered.hpp>
#include <clearance/io/field_cache.hpp>
#include <clearance/io/jacobian.hpp>
#include <clearance/io/mesh.hpp>
#include <clearance/io/part_radii.hpp>
#include <clearance/io/spheres_file.hpp>
#include <clearance/near_maps.hpp>

#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <functional>
#include <numeric>

using namespace clearance;

using row_major = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

namespace {

struct model_options {
  bool spheres = true;
  std::size_t count = 0;
  bool cache = true;
};

model_options options_of(const std::string& model, nb::handle spheres, bool cache) {
  model_options made{.count = pack_options{}.count, .cache = cache};
  if (model != "spheres" && model != "triangles")
    throw std::invalid_argument("clearance: model is \"" + model + "\"; it is \"spheres\" or \"triangles\"");
  made.spheres = model == "spheres";
  if (spheres.is_none()) return made;
  if (!made.spheres) throw std::invalid_argument("clearance: spheres=N is for model=\"spheres\"");
  made.count = count_of(spheres, "spheres");
  if (made.count == 0) throw std::invalid_argument("clearance: spheres is 0; a part needs at least one");
  return made;
}

/// What the caller changes afterwards changes no recipe.
nb::object copy_of(nb::handle given) { return nb::module_::import_("copy").attr("deepcopy")(given); }

const io::body& body_of(const robot_model& robot, given_for<std::size_t> part) {
  const std::size_t k = argument_of(part, "part", robot.names);
  check_number("part", k, robot.parts());
  return robot.bodies[k];
}

/// Tells Python's logger "clearance" what is being done, once a second from the first second on. From any thread, one
/// call at a time; none may hold the interpreter's lock.
class slow_work {
 public:
  void operator()(const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    if (now < due_) return;
    say(what);
    due_ = now + std::chrono::seconds(1);
  }
  /// At once, before what takes seconds.
  static void say(const std::string& what) {
    const nb::gil_scoped_acquire alone;
    try {
      nb::module_::import_("logging").attr("getLogger")("clearance").attr("info")("%s", what);
    } catch (nb::python_error& error) {  // a handler of the user's: the robot is made all the same
      error.discard_as_unraisable("clearance: logging what is being done");
    }
  }

 private:
  std::chrono::steady_clock::time_point due_ = std::chrono::steady_clock::now() + std::chrono::seconds(1);
};

void make(robot_model& made, const std::vector<io::body_source>& sources, const model_options& options) {
  io::body_account account;
  io::body_options how{.spheres = options.spheres, .pack = {.count = options.count}};
  if (options.cache) how.cache = io::packing_cache(io::packing_cache::usual_folder());
  slow_work told;
  how.doing = [&](const std::string& what) { told(what); };
  made.spheres = options.spheres;
  made.bodies = io::make_bodies(sources, how, account);
  made.notes.insert(made.notes.end(), account.notes.begin(), account.notes.end());
  build(made);
}

/// "y" or "z"; none for None.
std::optional<io::gltf_axis> gltf_axis_of(const std::optional<std::string>& up) {
  if (up && *up != "y" && *up != "z")
    throw std::invalid_argument("clearance: gltf_up is \"" + *up + "\"; it is \"y\", \"z\" or None");
  return up ? std::optional(*up == "y" ? io::gltf_axis::y : io::gltf_axis::z) : std::nullopt;
}

std::shared_ptr<robot_model> from_urdf(nb::handle urdf, const std::string& model, nb::object spheres,
                                       const std::string& geometry, const nb::dict& packages,
                                       const std::vector<std::string>& exclude_links, bool cache,
                                       const std::optional<std::string>& gltf_up) {
  const model_options options = options_of(model, spheres, cache);
  if (geometry != "collision" && geometry != "visual")
    throw std::invalid_argument("clearance: geometry is \"" + geometry + "\"; it is \"collision\" or \"visual\"");
  const auto made = std::make_shared<robot_model>();
  const std::string file = file_of(urdf, "file");
  io::robot_options reading;
  reading.gltf_up = gltf_axis_of(gltf_up);
  for (const auto& [name, folder] : packages)
    reading.packages[file_of(name, "the name of a package")] = file_of(folder, "the folder of a package");
  {
    const nb::gil_scoped_release others;
    reading.geometry = geometry == "visual" ? io::robot_geometry::visual : io::robot_geometry::collision;
    reading.exclude_links = exclude_links;
    made->description.emplace(is_text(file) ? io::load_robot_text(file, "robot_description", reading)
                                            : io::load_robot(file, reading));
    made->name = made->description->name(), made->notes = made->description->notes();
    std::vector<io::body_source> sources;
    for (const io::robot_part& part : made->description->parts())
      sources.push_back({part.name, &part.mesh, part.tessellation_error});
    make(*made, sources, options);
  }
  made->maker = "from_urdf",
  made->recipe = nb::make_tuple(file, model, spheres, geometry, copy_of(packages), exclude_links, cache, gltf_up);
  return made;
}

/// A mesh from a file's name, or from (vertices, triangles).
triangle_mesh mesh_of(const std::string& name, nb::handle given, std::optional<io::gltf_axis> up,
                      std::vector<std::string>& notes) {
  if (nb::isinstance<nb::str>(given) || nb::hasattr(given, "__fspath__")) {
    io::loaded_mesh read = io::load_mesh_noted(text_of(given), {}, up);
    for (const std::string& note : read.notes) notes.push_back(io::sentence_about("part " + io::quoted(name), note));
    return std::move(read.mesh);
  }
  try {
    nb::object vertices, faces;
    if (nb::hasattr(given, "vertices") && nb::hasattr(given, "faces"))
      vertices = given.attr("vertices"), faces = given.attr("faces");
    else
      vertices = given[nb::int_(0)], faces = given[nb::int_(1)];
    const nb::module_ numpy = nb::module_::import_("numpy");
    const auto v = nb::cast<nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig>>(
        numpy.attr("ascontiguousarray")(vertices, "f8"));
    const std::string kind = text_of(numpy.attr("asarray")(faces).attr("dtype").attr("kind"));
    if (kind != "i" && kind != "u")
      throw std::invalid_argument("clearance: the triangles of part " + io::quoted(name) +
                                  " are numbers of vertices, whole ones, not " + shape_and_type(faces));
    const auto f = nb::cast<nb::ndarray<const std::int64_t, nb::shape<-1, 3>, nb::c_contig>>(
        numpy.attr("ascontiguousarray")(faces, "i8"));
    triangle_mesh mesh;
    for (std::size_t i = 0; i < v.shape(0); ++i)
      mesh.vertices.push_back({v.data()[3 * i], v.data()[3 * i + 1], v.data()[3 * i + 2]});
    for (std::size_t i = 0; i < f.shape(0); ++i) {
      std::array<std::uint32_t, 3> t;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int64_t at = f.data()[3 * i + k];
        if (at < 0 || std::size_t(at) >= v.shape(0))
          throw std::invalid_argument("clearance: triangle " + std::to_string(i) + " of part " + io::quoted(name) +
                                      " names vertex " + std::to_string(at) + ", and there are " +
                                      std::to_string(v.shape(0)));
        t[k] = std::uint32_t(at);
      }
      mesh.triangles.push_back(t);
    }
    return mesh;
  } catch (const nb::cast_error&) {
  } catch (nb::python_error&) {
  }
  throw std::invalid_argument("clearance: part " + io::quoted(name) +
                              " is a mesh file, or (vertices of shape (n, 3), triangles of shape (m, 3)), not " +
                              shape_and_type(given));
}

std::shared_ptr<robot_model> from_meshes(const nb::dict& meshes, const std::string& model, nb::object spheres,
                                         const std::string& name, bool cache,
                                         const std::optional<std::string>& gltf_up) {
  const model_options options = options_of(model, spheres, cache);
  const auto up = gltf_axis_of(gltf_up);
  const auto made = std::make_shared<robot_model>();
  std::vector<std::string> names;
  std::vector<triangle_mesh> read;
  for (const auto& [key, mesh] : meshes) {
    names.push_back(nb::cast<std::string>(key));
    read.push_back(mesh_of(names.back(), mesh, up, made->notes));
  }
  made->name = name;
  {
    const nb::gil_scoped_release others;
    std::vector<io::body_source> sources;
    for (std::size_t k = 0; k < read.size(); ++k) sources.push_back({names[k], &read[k]});
    make(*made, sources, options);
  }
  made->maker = "from_meshes", made->recipe = nb::make_tuple(copy_of(meshes), model, spheres, name, cache, gltf_up);
  return made;
}

std::shared_ptr<robot_model> from_spheres(const nb::dict& given, double gap, double tolerance,
                                          const std::string& name) {
  const auto made = std::make_shared<robot_model>();
  made->name = name;
  for (const auto& [key, rows] : given) {
    const std::string part = nb::cast<std::string>(key);
    const nb::object plain = nb::module_::import_("numpy").attr("ascontiguousarray")(rows, "f4");
    nb::ndarray<const float, nb::shape<-1, 4>, nb::c_contig> array;
    if (!nb::try_cast(plain, array))
      throw std::invalid_argument("clearance: the spheres of part " + io::quoted(part) +
                                  " have the shape (n, 4): x, y, z, radius, in metres; not " + shape_and_type(rows));
    io::body body{.name = part, .packed = {}, .closed = {}, .tolerance = tolerance};
    for (std::size_t i = 0; i < array.shape(0); ++i) {
      const float* const s = array.data() + 4 * i;
      if (!(std::isfinite(s[0]) && std::isfinite(s[1]) && std::isfinite(s[2]) && s[3] >= 0 && std::isfinite(s[3])))
        throw std::invalid_argument("clearance: sphere " + std::to_string(i) + " of part " + io::quoted(part) +
                                    " is not finite, or its radius is negative");
      body.packed.spheres.push_back({{s[0], s[1], s[2]}, s[3]});
    }
    body.packed.gap = gap;
    made->bodies.push_back(std::move(body));
  }
  build(*made);
  made->maker = "from_spheres", made->recipe = nb::make_tuple(copy_of(given), gap, tolerance, name);
  return made;
}

template <class Model>
std::shared_ptr<const robot_trees<>> owned(Model model) {
  return std::make_shared<const robot_trees<>>(std::move(model));
}

/// The trees with fields, from the cache or sampled on a device; `without` says why a part has none.
std::shared_ptr<const robot_trees<>> fielded_trees(const robot_trees<>& trees, const field_options& options, int device,
                                                   const io::field_cache& cache, std::vector<std::string>& without) {
  return std::visit(
      [&](const auto& bare) {
        if (device == on_the_host) {
          auto made = io::with_fields_cached(host{}, bare, options, cache);
          without = std::move(made.without);
          return owned(std::move(made.model));
        }
        if (auto kept = io::with_kept_fields(bare, options, cache); kept.found > 0) return owned(std::move(kept.model));
        const auto made = open_device_door().with_near_map(trees, options, without, device);
        const auto& model = std::get<std::remove_cvref_t<decltype(bare)>>(*made);
        for (std::size_t k = 0; k < model.fields().size(); ++k) cache.keep(model.parts()[k], model.fields()[k]);
        return made;
      },
      trees);
}

/// The trees with cells, made on a device; `without` says why a part has none.
std::shared_ptr<const robot_trees<>> celled_trees(const robot_trees<>& trees, const cell_options& options, int device,
                                                  std::vector<std::string>& without) {
  if (device != on_the_host) return open_device_door().with_near_map(trees, options, without, device);
  return std::visit(
      [&](const auto& bare) {
        auto made = with_cells(host{}, bare, options);
        without = std::move(made.without);
        return owned(std::move(made.model));
      },
      trees);
}

/// The same robot, made again by `maker`, with the trees that `make(without)` returns. Of a part of which `without`
/// says why it has none there is a note, which ends with `so`.
template <class Make>
std::shared_ptr<robot_model> mapped_robot(const robot_model& robot, const char* maker, nb::object recipe,
                                          const Make& make, const std::string& doing, const char* so) {
  const auto made = std::make_shared<robot_model>();
  made->maker = maker, made->recipe = std::move(recipe);
  const nb::gil_scoped_release others;
  made->name = robot.name, made->names = robot.names, made->bodies = robot.bodies, made->notes = robot.notes;
  made->description = robot.description, made->spheres = robot.spheres;
  made->held = robot.held;
  std::vector<std::string> without;
  slow_work::say(doing + " of " + std::to_string(robot.parts()) + " parts");
  made->trees = make(without);
  for (std::size_t k = 0; k < without.size(); ++k)
    if (!without[k].empty())
      made->notes.push_back("part " + io::quoted((*robot.names)[k]) + ": " + without[k] + "; " + so);
  return made;
}

/// A robot that Python holds, with fields.
std::shared_ptr<robot_model> fielded_robot(const nb::object& self, nb::handle bytes, const std::string& device,
                                           bool cache) {
  const auto& robot = nb::cast<const robot_model&>(self);
  const std::size_t size = count_of(bytes, "bytes");
  const int where = device_number(device);
  const io::field_cache kept(cache ? io::packing_cache::usual_folder() : std::filesystem::path());
  return mapped_robot(
      robot, "with_fields", nb::make_tuple(self, size, "cpu", cache),  // on any machine: no answer depends on where
      [&](auto& without) { return fielded_trees(*robot.trees, {size}, where, kept, without); },
      "reading or sampling fields", "so no field is used");
}

/// One with cells.
std::shared_ptr<robot_model> celled_robot(const nb::object& self, nb::handle bytes, double reach,
                                          const std::string& device) {
  const auto& robot = nb::cast<const robot_model&>(self);
  const std::size_t size = count_of(bytes, "bytes");
  const int where = device_number(device);
  return mapped_robot(
      robot, "with_cells", nb::make_tuple(self, size, reach, "cpu"),
      [&](auto& without) { return celled_trees(*robot.trees, {size, reach}, where, without); }, "making cells",
      "so it has none");
}

/// One of the facts that brackets have, of each part.
nb::object facts_of(const robot_model& robot, real part_facts::* which) {
  std::vector<double> all;
  std::visit(
      [&](const auto& trees) {
        for (const part_facts& facts : trees.view().facts) all.push_back(double(facts.*which));
      },
      *robot.trees);
  const std::size_t n = all.size();
  return own_array(std::move(all), {n});
}

/// The robot's tree, in which joints that follow others are free where `values` names them.
std::shared_ptr<const io::kinematic_tree> freed_tree(const robot_model& robot,
                                                     const std::map<std::string, double>& values) {
  const io::kinematic_tree& tree = joints_of(robot);
  std::vector<std::string> names;
  for (const auto& [name, value] : values) names.push_back(name);
  names = io::followers_among(tree, names);
  if (names.empty()) return {std::shared_ptr<void>(), &tree};
  const std::scoped_lock lock(robot.freeing);
  auto& kept = robot.freed[names];
  if (!kept) kept = std::make_shared<const io::kinematic_tree>(io::freed(tree, names));
  return kept;
}

/// A number for each of the tree's values, or one for all.
std::vector<double> each_joint(const robot_model& robot, const io::kinematic_tree& tree, nb::handle given,
                               const char* argument) {
  if (given.is_none()) return {};
  std::vector<double> all;
  if (double one = 0; nb::try_cast(given, one)) return std::vector<double>(tree.size(), one);
  if (tree.size() != joints_of(robot).size())
    throw std::invalid_argument(std::string("clearance: ") + argument +
                                " is one number for all here, because a joint that follows another has a value of "
                                "its own, and Robot.joints does not name it");
  if (!nb::try_cast(nb::module_::import_("numpy").attr("asarray")(given).attr("tolist")(), all))
    throw std::invalid_argument(std::string("clearance: ") + argument + " is a number, or one for each of the " +
                                std::to_string(joints_of(robot).size()) + " joints, not " + shape_and_type(given));
  return all;
}

/// Throws std::invalid_argument if there are several.
joint_rows one_configuration(const robot_model& robot, nb::handle joints, joint_reading how) {
  joint_rows rows = joints_given(robot, joints, how);
  if (!rows.shape.empty())
    throw std::invalid_argument("clearance: joints is of one configuration here, not " + shape_and_type(joints));
  return rows;
}

nb::object radii_of_parts(const robot_model& robot, nb::handle joints, nb::handle errors, nb::handle speeds,
                          double delay, bool ignore_limits, bool rest) {
  const joint_rows q = one_configuration(robot, joints, {ignore_limits, rest});
  const std::vector<double> wrong = each_joint(robot, *q.tree, errors, "errors"),
                            fast = each_joint(robot, *q.tree, speeds, "speeds");
  std::vector<std::size_t> links;
  for (const io::robot_part& part : robot.described().parts()) links.push_back(part.link);
  auto* const radii = new std::vector<part_radius>(std::visit(
      [&](const auto& trees) {
        return io::part_radii(*q.tree, links, trees.view().facts, q.values, {wrong, fast, delay}, {ignore_limits});
      },
      *robot.trees));
  return array_of(radii->data(), radii->size(),
                  nb::capsule(radii, [](void* p) noexcept { delete static_cast<std::vector<part_radius>*>(p); }));
}

}  // namespace

void build(robot_model& made) {
  const auto options = [&](std::size_t k) { return part_options{.tolerance = made.bodies[k].tolerance}; };
  if (made.spheres)
    made.trees = std::make_shared<const robot_trees<>>(
        make_model<sphere>(made.bodies | std::views::transform(&io::body::packed), options));
  else
    made.trees = std::make_shared<const robot_trees<>>(
        make_model<obb>(made.bodies | std::views::transform(&io::body::closed), options));
  std::vector<std::string> names;
  for (const io::body& body : made.bodies) names.push_back(body.name);
  made.names = std::make_shared<const std::vector<std::string>>(std::move(names));
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 12;
  std::string text;
  for (std::size_t k = 0; k < std::min(names.size(), most); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " and " : ", ") + io::quoted(names[k]);
  return text + (names.size() > most ? " and " + std::to_string(names.size() - most) + " more" : "");
}

nb::object rows_of(const std::vector<Eigen::Isometry3d>& poses, std::vector<std::size_t> shape) {
  std::vector<double> values(16 * poses.size());
  for (std::size_t k = 0; k < poses.size(); ++k) Eigen::Map<row_major>(values.data() + 16 * k) = poses[k].matrix();
  shape.push_back(4), shape.push_back(4);
  return own_array(std::move(values), shape);
}

const io::robot& robot_model::described() const {
  if (!description)
    throw std::invalid_argument(
        "clearance: this robot has no joints, because it was not read from a URDF file; give poses");
  return *description;
}

joint_rows joints_given(const robot_model& robot, nb::handle given, joint_reading how) {
  const io::kinematic_tree& tree = joints_of(robot);
  joint_rows rows{{}, {}, {std::shared_ptr<void>(), &tree}};
  if (given.is_none() || nb::isinstance<nb::dict>(given)) {
    std::map<std::string, double> values;
    if (!given.is_none() && !nb::try_cast(given, values))
      throw std::invalid_argument("clearance: joints, as a dictionary, has numbers by the names of joints");
    rows.tree = freed_tree(robot, values);
    std::vector<std::string> unsaid;
    for (std::size_t i = 0; i < rows.tree->size(); ++i)
      if (const std::string& name = rows.tree->movable(i).name; !values.contains(name)) unsaid.push_back(name);
    rows.values = named([&] { return rows.tree->configuration(values, {how.ignore_limits}); });
    if (!unsaid.empty() && !how.rest)
      throw std::invalid_argument(std::string("clearance: ") +
                                  (given.is_none() ? "joints are not given, of " : "joints says nothing of ") +
                                  listed(unsaid) + "; rest=True puts such joints at rest");
    return rows;
  }
  matrix_array array;
  if (!nb::try_cast(given, array)) {
    nb::object plain;
    try {
      plain = nb::module_::import_("numpy").attr("ascontiguousarray")(given, "f8");
    } catch (nb::python_error&) {
      plain = nb::none();
    }
    if (!nb::try_cast(plain, array))
      throw std::invalid_argument("clearance: joints has the shape (..., " + std::to_string(tree.size()) +
                                  ") and numbers, not " + shape_and_type(given));
  }
  if (array.ndim() == 0 || array.shape(array.ndim() - 1) != tree.size())
    throw std::invalid_argument("clearance: joints has the shape (..., " + std::to_string(tree.size()) +
                                "), one value for each movable joint, not " + shape_and_type(given));
  rows.values.assign(array.data(), array.data() + array.size());
  for (std::size_t k = 0; k + 1 < array.ndim(); ++k) rows.shape.push_back(array.shape(k));
  return rows;
}

std::vector<Eigen::Isometry3d> poses_of(nb::handle given, const char* argument, std::vector<std::size_t>* shape) {
  matrix_array array;
  if (!nb::try_cast(given, array)) {
    nb::object plain = nb::none();
    try {
      plain = nb::module_::import_("numpy").attr("ascontiguousarray")(given, "f8");
    } catch (nb::python_error&) {
    }
    if (!nb::try_cast(plain, array))
      throw std::invalid_argument(std::string("clearance: ") + argument + " has the shape (..., 4, 4), not " +
                                  shape_and_type(given));
  }
  if (array.ndim() < 2 || array.shape(array.ndim() - 1) != 4 || array.shape(array.ndim() - 2) != 4)
    throw std::invalid_argument(std::string("clearance: ") + argument + " has the shape (..., 4, 4), not " +
                                shape_and_type(given));
  if (shape)
    for (std::size_t k = 0; k + 2 < array.ndim(); ++k) shape->push_back(array.shape(k));
  std::vector<Eigen::Isometry3d> poses(array.size() / 16);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Map<const row_major> m(array.data() + 16 * k);
    if (m.row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      throw std::invalid_argument(std::string("clearance: the last row of ") + argument + " is 0, 0, 0, 1" +
                                  (poses.size() > 1 ? "; that of number " + std::to_string(k) + " is not" : ""));
    poses[k].matrix() = m;
  }
  return poses;
}

Eigen::Isometry3d pose_of(nb::handle given, const char* argument) {
  if (given.is_none()) return Eigen::Isometry3d::Identity();
  const auto poses = poses_of(given, argument);
  if (poses.size() != 1)
    throw std::invalid_argument(std::string("clearance: ") + argument + " is one pose of shape (4, 4), not " +
                                shape_and_type(given));
  return poses[0];
}

bool is_text(const std::string& given) {
  const std::size_t first = given.find_first_not_of(" \t\r\n");
  return first != given.npos && given[first] == '<';
}

std::size_t joint_rows::size() const {
  return std::accumulate(shape.begin(), shape.end(), std::size_t(1), std::multiplies<>());
}

std::vector<Eigen::Isometry3d> joint_rows::links(std::size_t configuration, const Eigen::Isometry3d& base,
                                                 bool ignore_limits) const {
  const std::size_t dof = tree->size();
  std::string which;
  for (std::size_t k = shape.size(), left = configuration; k-- > 0; left /= shape[k])
    which = std::to_string(left % shape[k]) + (which.empty() ? "" : ", ") + which;
  if (!which.empty()) which = "joints[" + which + "]: ";
  auto poses = named(
      [&] { return tree->link_poses(std::span(values).subspan(configuration * dof, dof), {ignore_limits}); }, which);
  for (Eigen::Isometry3d& pose : poses) pose = base * pose;
  return poses;
}

std::vector<Eigen::Isometry3d> placed_parts(const robot_model& robot, const joint_rows& joints,
                                            const Eigen::Isometry3d& base, bool ignore_limits) {
  const std::size_t configurations = joints.size();
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(configurations * robot.parts());
  for (std::size_t c = 0; c < configurations; ++c) {
    const auto links = joints.links(c, base, ignore_limits);
    for (const io::robot_part& part : robot.described().parts()) poses.push_back(links[part.link]);
  }
  return poses;
}

placed_robot robot_at(const robot_model& robot, nb::handle joints, nb::handle base, joint_reading how) {
  const Eigen::Isometry3d to = pose_of(base, "base");
  if (robot.description || !joints.is_none()) {
    const joint_rows rows = joints_given(robot, joints, how);
    return {placed_parts(robot, rows, to, how.ignore_limits), rows.shape};
  }
  if (robot.parts() != 0 && !how.rest && !(robot.parts() == 1 && !base.is_none()))
    throw std::invalid_argument("clearance: poses are not given, and nothing else says where part " +
                                io::quoted((*robot.names)[0]) + (robot.parts() > 1 ? " and the others are" : " is") +
                                ", because this robot was not read from a URDF file; rest=True puts all parts where "
                                "the base is");
  return {std::vector(robot.parts(), to), {}};
}

placed_robot robot_placed(const robot_model& robot, nb::handle joints, nb::handle poses, nb::handle base,
                          joint_reading how) {
  if (poses.is_none()) return robot_at(robot, joints, base, how);
  if (!joints.is_none() || !base.is_none() || how.rest)
    throw std::invalid_argument("clearance: poses are given, so joints, base and rest cannot be");
  placed_robot made;
  made.poses = poses_of(poses, "poses", &made.shape);
  if (!made.shape.empty() && made.shape.back() == robot.parts())
    made.shape.pop_back();
  else
    made.shape.clear();
  return made;
}

io::digest digest_of(std::span<const Eigen::Isometry3d> poses) {
  static_assert(sizeof(Eigen::Isometry3d) == 16 * sizeof(double));
  return io::digest_of(std::string_view(reinterpret_cast<const char*>(poses.data()), poses.size_bytes()));
}

std::vector<std::size_t> own_columns(const robot_model& robot, const io::kinematic_tree& from) {
  std::vector<std::size_t> columns;
  const io::kinematic_tree& own = joints_of(robot);
  for (std::size_t i = 0; i < from.size() && columns.size() < own.size(); ++i)  // both have the order of the joints
    if (from.movable(i).name == own.movable(columns.size()).name) columns.push_back(i);
  return columns;
}

void bind_robot(nb::module_& m) {
  nb::class_<robot_model>(
      m, "Robot",
      "A robot's rigid parts, each with a tree that is built once, and its joints. It never changes; any number of "
      "queries and threads may share it.")
      .def_static(
          "from_urdf", &from_urdf, nb::arg("file"), nb::arg("model") = "spheres",
          nb::arg("spheres").none() = nb::none(), nb::arg("geometry") = "collision", nb::arg("packages") = nb::dict(),
          nb::arg("exclude_links") = std::vector<std::string>(), nb::arg("cache") = true,
          nb::arg("gltf_up").none() = nb::none(),
          "Reads a URDF file and its meshes; or a description itself, such as ROS's robot_description or what xacro "
          "gives, whose meshes are found from the working folder. model: \"spheres\" (packed into each link, `spheres` "
          "of them; kept "
          "in the cache) or \"triangles\" (exact). packages: the folder of package://name. gltf_up: \"y\" or \"z\", "
          "which "
          "axis of glTF meshes is up; None: as a link's other geometry shows, else y, with a note. Raises RuntimeError "
          "if a file is damaged or missing, ValueError if an option cannot be.")
      .def_static(
          "from_meshes", &from_meshes, nb::arg("meshes"), nb::arg("model") = "spheres",
          nb::arg("spheres").none() = nb::none(), nb::arg("name") = "robot", nb::arg("cache") = true,
          nb::arg("gltf_up").none() = nb::none(),
          "One part for each {name: mesh}: a file's name, (vertices (n, 3), triangles (m, 3)), or an object with "
          "vertices and faces. Metres. gltf_up: as of from_urdf.")
      .def_static("from_spheres", &from_spheres, nb::arg("spheres"), nb::arg("gap") = 0.0, nb::arg("tolerance") = 0.0,
                  nb::arg("name") = "robot",
                  "One part for each {name: array (n, 4) of x, y, z, radius}. Metres. gap: the largest distance of the "
                  "solid to its spheres (inf: unknown, so there is no lower bound).")
      .def(
          "with_fields", &fielded_robot, nb::arg("bytes").none() = field_options{}.bytes, nb::arg("device") = "cpu",
          nb::arg("cache") = true,
          "The same robot with a field of so many bytes around each part: questions about many configurations take "
          "less time then, and no answer changes. device: where it is sampled, \"cpu\" (seconds a part) or \"cuda:0\"; "
          "once, and kept in the cache. If a part can have none, none is used, and `notes` say why.")
      .def_prop_ro(
          "has_fields",
          [](const robot_model& r) { return std::visit([](const auto& m) { return !m.fields().empty(); }, *r.trees); },
          "Whether the robot was made by with_fields, and its fields are used.")
      .def(
          "with_cells", &celled_robot, nb::arg("bytes").none() = cell_options{}.bytes,
          nb::arg("reach") = cell_options{}.reach, nb::arg("device") = "cpu",
          "The same robot with cells around each part, of at most so many bytes, as far as reach (metres): a GPU tells "
          "every point's distance in less time then, and no answer changes. device: where they are made, \"cpu\" "
          "(seconds a part) or \"cuda:0\". A part that can have none keeps its tree alone, and `notes` say why.")
      .def_prop_ro(
          "has_cells",
          [](const robot_model& r) { return std::visit([](const auto& m) { return !m.cells().empty(); }, *r.trees); },
          "Whether the robot was made by with_cells, and a part has cells.")
      .def("attach", &attached_robot, nb::arg("link"), nb::arg("object").none(), nb::arg("pose").none() = nb::none(),
           "The robot with an object that one of its links holds: joints, many configurations and gradients go on as "
           "before. object: a Robot without joints, of the same model, whose parts' names are new. pose: "
           "link-from-object, (4, 4). Near maps are not kept. Raises ValueError otherwise.")
      .def("release", &released_robot, nb::arg("parts") = std::vector<std::string>(),
           "The robot without these parts of what is attached, by their names; by default without all of it.")
      .def_prop_ro(
          "attached", [](const robot_model& r) { return r.held; }, "The names of the parts that are attached.")
      .def_prop_ro(
          "name", [](const robot_model& r) { return r.name; }, "As its description, or the caller, names it.")
      .def_prop_ro(
          "model", [](const robot_model& r) { return r.spheres ? "spheres" : "triangles"; },
          "\"spheres\" or \"triangles\": what stands for its solids.")
      .def_prop_ro(
          "parts", [](const robot_model& r) { return *r.names; }, "The names of the parts, in their order.")
      .def_prop_ro(
          "notes", [](const robot_model& r) { return r.notes; }, "What a person should know about its files.")
      .def_prop_ro(
          "joints",
          [](const robot_model& r) {
            std::vector<std::string> names;
            if (r.description)
              for (std::size_t i = 0; i < joints_of(r).size(); ++i) names.push_back(joints_of(r).movable(i).name);
            return names;
          },
          "The names of the movable joints, in the order of joint values.")
      .def_prop_ro(
          "mimics",
          [](const robot_model& r) {
            nb::dict all;
            if (r.description)
              for (const io::joint& j : joints_of(r).joints())
                if (j.follows)
                  all[j.name.c_str()] = nb::make_tuple(j.follows->joint, j.follows->multiplier, j.follows->offset);
            return all;
          },
          nb::sig("def mimics(self) -> dict[str, tuple[str, float, float]]"),
          "The joints that follow others, {name: (other, multiplier, offset)}. A value that joints, as a dictionary, "
          "gives one of them wins, as with ROS's robot_state_publisher.")
      .def_prop_ro(
          "insides",
          [](const robot_model& r) {
            nb::list all;
            for (const io::body& b : r.bodies)
              all.append(b.closed.loaded == 0 ? nb::none() : nb::object(nb::str(to_string(b.closed.inside))));
            return all;
          },
          nb::sig("def insides(self) -> list[str | None]"),
          "How each part's inside is known: \"closed\", \"caps\", \"flood\" or \"nothing\"; None: there is no mesh.")
      .def_prop_ro(
          "tolerances", [](const robot_model& r) { return facts_of(r, &part_facts::tolerance); },
          "By how much each part's solid may differ from the true surface, either way, (parts,): metres. Brackets are "
          "wider by it.")
      .def_prop_ro(
          "gaps", [](const robot_model& r) { return facts_of(r, &part_facts::gap); },
          "How far each part's solid may be from its spheres or triangles, (parts,): metres; inf: unknown.")
      .def_prop_ro(
          "limits",
          [](const robot_model& r) {
            std::vector<double> ranges;
            const std::size_t n = r.description ? joints_of(r).size() : 0;
            for (std::size_t i = 0; i < n; ++i)
              ranges.push_back(joints_of(r).movable(i).lower), ranges.push_back(joints_of(r).movable(i).upper);
            return own_array(std::move(ranges), {n, 2});
          },
          "The joints' lower and upper limits, (joints, 2): radians or metres.")
      .def_prop_ro(
          "rest",
          [](const robot_model& r) {
            auto q = joints_of(r).rest();
            const auto n = q.size();
            return own_array(std::move(q), {n});
          },
          "Each joint at 0, or at the limit nearest to it.")
      .def(
          "poses",
          [](const robot_model& r, nb::handle joints, nb::handle base, bool ignore_limits, bool rest) {
            auto [poses, shape] = robot_at(r, joints, base, {ignore_limits, rest});
            shape.push_back(r.parts());
            return rows_of(poses, shape);
          },
          nb::arg("joints").none() = nb::none(), nb::arg("base").none() = nb::none(), nb::arg("ignore_limits") = false,
          nb::arg("rest") = false,
          "World-from-part of every part, (..., parts, 4, 4), for joints (..., joints) or {name: value}, where a joint "
          "of `mimics` may have a value of its own, too. base is world-from-base. Raises ValueError for values beyond "
          "the limits, and for joints that nothing is said of, unless rest: then they are at rest.")
      .def(
          "link_pose",
          [](const robot_model& r, const std::string& link, nb::handle joints, nb::handle base, bool ignore_limits,
             bool rest) {
            const std::size_t number = named([&] { return joints_of(r).link(link); });
            const joint_rows q = one_configuration(r, joints, {ignore_limits, rest});
            return rows_of({q.links(0, pose_of(base, "base"), ignore_limits)[number]}, {});
          },
          nb::arg("link"), nb::arg("joints").none() = nb::none(), nb::arg("base").none() = nb::none(),
          nb::arg("ignore_limits") = false, nb::arg("rest") = false,
          "World-from-link of any link, (4, 4): with geometry or without, such as a camera's. Arguments are those of "
          "poses.")
      .def(
          "jacobian",
          [](const robot_model& r, nb::handle joints, nb::handle part, nb::handle point, nb::handle base,
             bool ignore_limits, bool rest) {
            const joint_rows q = one_configuration(r, joints, {ignore_limits, rest});
            const auto at = three_of(point, "at");
            std::size_t k = 0;
            if (nb::isinstance<nb::str>(part)) {
              const auto name = nb::cast<std::string>(part);
              while (k < r.parts() && (*r.names)[k] != name) ++k;
              if (k == r.parts()) throw std::invalid_argument("clearance: the robot has no part " + io::quoted(name));
            } else if (k = count_of(part, "part"); k >= r.parts()) {
              throw std::invalid_argument("clearance: the robot has " + std::to_string(r.parts()) +
                                          " parts, and none of number " + std::to_string(k));
            }
            const auto links = q.links(0, pose_of(base, "base"), ignore_limits);
            const auto moved = io::jacobian(*q.tree, links, r.described().parts()[k].link, {at[0], at[1], at[2]});
            const std::vector<std::size_t> columns = own_columns(r, *q.tree);
            std::vector<double> rows;
            for (Eigen::Index i = 0; i < moved.rows(); ++i)
              for (const std::size_t j : columns) rows.push_back(moved(i, Eigen::Index(j)));
            return own_array(std::move(rows), {6, columns.size()});
          },
          nb::arg("joints").none(), nb::arg("part").none(), nb::arg("at").none(), nb::arg("base").none() = nb::none(),
          nb::arg("ignore_limits") = false, nb::arg("rest") = false,
          "What each joint does to a part, (6, joints): the velocity of its point at `at` (world, metres), then its "
          "angular velocity, per radian or metre.")
      .def("part_radii", &radii_of_parts, nb::arg("joints").none(), nb::arg("errors").none() = nb::none(),
           nb::arg("speeds").none() = nb::none(), nb::arg("delay") = 0.0, nb::arg("ignore_limits") = false,
           nb::arg("rest") = false,
           "How far each part may be from where joints have it, for CertainDistance(parts=...): records of joints and "
           "delay, metres. errors (rad, m): by how much joints may be wrong; speeds, per second, in the seconds of "
           "delay; one number, or one a joint. Raises ValueError for what is negative or not finite.")
      .def(
          "spheres",
          [](const robot_model& r, given_for<std::size_t> k) {
            const auto& all = body_of(r, k).packed.spheres;
            std::vector<float> rows;
            for (const inner_sphere& s : all) rows.insert(rows.end(), {s.center.x, s.center.y, s.center.z, s.radius});
            return own_array(std::move(rows), {all.size(), 4});
          },
          nb::arg("part").none(), "The inner spheres of a part, (n, 4): x, y, z, radius in the part's frame. Metres.")
      .def(
          "mesh",
          [](const robot_model& r, given_for<std::size_t> k) {
            const auto& mesh = body_of(r, k).closed.surface;
            std::vector<double> vertices;
            std::vector<std::uint32_t> triangles;
            for (const auto& v : mesh.vertices) vertices.insert(vertices.end(), {v.x(), v.y(), v.z()});
            for (const auto& t : mesh.triangles) triangles.insert(triangles.end(), {t[0], t[1], t[2]});
            return nb::make_tuple(own_array(std::move(vertices), {mesh.vertices.size(), 3}),
                                  own_array(std::move(triangles), {mesh.triangles.size(), 3}));
          },
          nb::arg("part").none(),
          "The closed mesh of a part: vertices (n, 3) in its frame, metres, and triangles (m, 3).")
      .def("__reduce__",
           [](const robot_model& r) {
             const nb::object all = nb::make_tuple(r.maker) + r.recipe;
             return nb::make_tuple(nb::module_::import_("clearance._made").attr("robot"), all);
           })
      .def("__len__", &robot_model::parts)
      .def("__repr__", [](const robot_model& r) {
        std::size_t n = 0;
        for (const auto& body : r.bodies)
          n += r.spheres ? body.packed.spheres.size() : body.closed.surface.triangles.size();
        return "<Robot " + io::quoted(r.name) + ": " + std::to_string(r.parts()) + " parts, " + std::to_string(n) +
               (r.spheres ? " spheres>" : " triangles>");
      });
}
