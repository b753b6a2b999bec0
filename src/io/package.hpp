// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// Finds the files that a URDF names: in ROS packages, by their paths, or where another machine's paths would be here.

#include "io/uri.hpp"
#include "io/xml.hpp"

#include <clearance/io/error.hpp>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace clearance::io {

/// Does a folder have a package.xml with this package name?
inline bool is_package(const std::filesystem::path& folder, std::string_view name) {
  std::error_code failed;
  const auto file = folder / "package.xml";
  if (!std::filesystem::is_regular_file(file, failed)) return false;
  try {
    const xml_element root = read_xml(read_bytes(file.string()), file.string());
    for (const auto& child : root.children) {
      std::string_view found = child.text;
      if (root.name == "package" && child.name == "name" && take_word(found, " \t\r\n") == name) return true;
    }
  } catch (const std::runtime_error&) {  // unreadable counts as absent; if the package was needed, that is reported
  }
  return false;
}

/// Folders where a package may be, the likeliest first: as given, then folders above `urdf` (with that name, a
/// package.xml with it, or one beside), ROS_PACKAGE_PATH, and share/<name> in AMENT_PREFIX_PATH.
inline std::vector<std::filesystem::path> find_package(const std::string& name, const std::filesystem::path& urdf,
                                                       const std::map<std::string, std::filesystem::path>& given) {
  namespace fs = std::filesystem;
  if (const auto at = given.find(name); at != given.end()) return {at->second};
  std::vector<fs::path> found;
  std::error_code failed;
  const auto add = [&](const fs::path& folder, bool fits) {
    if (fits && fs::is_directory(folder, failed)) found.push_back(folder);
  };

  fs::path above = fs::weakly_canonical(fs::absolute(urdf), failed).parent_path();
  for (bool more = !above.empty(); more; above = above.parent_path()) {
    add(above, above.filename() == name || is_package(above, name));
    add(above / name, true);
    more = above != above.root_path();
  }

  const auto each = [](const char* variable, auto visit) {
    const char* value = std::getenv(variable);
    std::string_view rest = value ? value : "";
    while (!rest.empty()) {
      const std::string_view entry = rest.substr(0, rest.find(':'));
      rest.remove_prefix(std::min(entry.size() + 1, rest.size()));
      if (!entry.empty()) visit(fs::path(entry));
    }
  };

  each("ROS_PACKAGE_PATH", [&](const fs::path& root) {
    add(root, root.filename() == name || is_package(root, name));
    add(root / name, true);
    for (fs::directory_iterator at(root, failed), end; !failed && at != end; at.increment(failed)) {
      add(at->path(), is_package(at->path(), name));
      add(at->path() / name, true);
    }
  });
  each("AMENT_PREFIX_PATH", [&](const fs::path& prefix) { add(prefix / "share" / name, true); });
  return found;
}

/// A folder at, above or beside a URDF that contains this path, as the package would; empty if there is none.
inline std::filesystem::path guess_package(const std::filesystem::path& inside, const std::filesystem::path& urdf) {
  namespace fs = std::filesystem;
  std::error_code failed;
  fs::path above = fs::weakly_canonical(fs::absolute(urdf), failed).parent_path();
  for (int levels = 0; levels < 4 && above != above.root_path(); ++levels, above = above.parent_path()) {
    if (fs::exists(above / inside, failed)) return above;
    int seen = 0;
    for (fs::directory_iterator at(above, failed), end; !failed && at != end && ++seen <= 1000; at.increment(failed))
      if (at->is_directory(failed) && fs::exists(at->path() / inside, failed)) return at->path();
  }
  return {};
}

/// Finds the files that a URDF names.
class mesh_lookup {
 public:
  using folders = std::map<std::string, std::filesystem::path>;

  struct found {
    std::filesystem::path file;
    std::string note{};  ///< How it was found, if that needs to be said; it goes on after the link's name.
  };

  mesh_lookup(const std::filesystem::path& urdf, const folders& packages) : urdf_(urdf), packages_(packages) {}

  /// The file that is meant by package://name/path, model://name/path (a simulator's name for the same), file:///path,
  /// file:/path, or a path relative to the URDF's folder (file://path too). %20 is a blank, if no name has it. An
  /// absolute path that is not here is one of another machine: what follows the name of a package is looked up in that.
  /// Throws std::runtime_error if the package is not found, or for another scheme.
  found operator()(const std::string& uri) {
    if (uri.empty()) refuse(urdf_.string(), "a mesh has an empty file name");
    if (uri.find("$(") != uri.npos || uri.find("${") != uri.npos)
      refuse(urdf_.string(), io::quoted(uri) + " has xacro in it: expand it with xacro first");
    if (uri.starts_with("package://") || uri.starts_with("model://")) return in_package(uri);
    if (uri.starts_with("file:")) {
      std::string path = uri.substr(5);
      if (path.starts_with("//")) path.erase(0, 2);  // "file://a/b" is how some say a/b
      if (path.starts_with("localhost/")) path.erase(0, 9);
      return written(path);
    }
    if (uri.find("://") != uri.npos)
      refuse(urdf_.string(),
             io::quoted(uri) + " is none of package://name/path, model://name/path, file:///path and a relative path");
    return written(uri);
  }

  /// The packages that were given and that no file was in.
  std::vector<std::string> unused() const {
    std::vector<std::string> names;
    for (const auto& [name, folder] : packages_)
      if (!used_.contains(name)) names.push_back(name);
    return names;
  }

 private:
  static bool exists(const std::filesystem::path& file) {
    std::error_code failed;
    return std::filesystem::exists(file, failed);
  }

  found in_package(const std::string& uri) {
    std::string_view rest = std::string_view(uri).substr(uri.find("://") + 3);
    rest.remove_prefix(std::min(rest.find_first_not_of('/'), rest.size()));  // package:///name means package://name
    const std::string name(rest.substr(0, rest.find_first_of("/\\")));
    const std::string inside(rest.substr(std::min(name.size() + 1, rest.size())));
    if (const auto beside = written_path(urdf_.parent_path(), name); inside.empty() && !name.empty() && is_file(beside))
      return {beside, "has a mesh that names a file as its package, and that file is beside the description"};
    if (name.empty() || inside.empty()) refuse(urdf_.string(), io::quoted(uri) + " names no file in a package");
    used_.insert(name);
    const auto all = find_package(name, urdf_, packages_);
    for (const auto& folder : all)
      if (const auto file = written_path(folder, inside); exists(file)) return {file};
    if (!all.empty()) return {all.front() / inside};  // the reader that opens it reports that it is missing
    refuse(urdf_.string(), "the package " + io::quoted(name) + " is not found: " + advice(name, inside));
  }

  found written(const std::string& path) {
    const std::filesystem::path file = written_path(urdf_.parent_path(), path);
    std::string plain = percent_decoded(path);
    std::ranges::replace(plain, '\\', '/');
    const bool drive = plain.size() > 2 && plain[1] == ':' && plain[2] == '/';
    if (exists(file) || !(plain.starts_with('/') || drive)) return {file};
    return of_another_machine(plain);
  }

  found of_another_machine(const std::string& path) {
    std::vector<std::size_t> starts;  // of names in it
    for (std::size_t slash = path.find('/'); slash != path.npos; slash = path.find('/', slash + 1))
      starts.push_back(slash + 1);
    const auto name_at = [&](std::size_t k) { return path.substr(starts[k], starts[k + 1] - 1 - starts[k]); };

    for (std::size_t k = starts.size(); k-- > 1;) {  // the last first: a package may be below a folder of its name
      const auto given = packages_.find(name_at(k - 1));
      if (given == packages_.end()) continue;
      used_.insert(given->first);
      if (const auto file = given->second / path.substr(starts[k]); exists(file)) return {file};
    }

    for (std::size_t k = starts.size(); k-- > 2;)
      if (name_at(k - 2) == "share" && !packages_.contains(name_at(k - 1)))
        for (const auto& folder : find_package(name_at(k - 1), urdf_, packages_))
          if (const auto file = folder / path.substr(starts[k]); exists(file))
            return {file,
                    "has a mesh by a path that is not on this machine, which is taken from the package of its "
                    "name here (--package " +
                        sentence(name_at(k - 1), 60) + "=FOLDER takes it from FOLDER)"};

    const std::string missing = sentence(path, 120) + ": there is no such file";
    for (std::size_t k = 1; k < starts.size(); ++k) {
      const std::string name = name_at(k - 1), inside = path.substr(starts[k]);
      const bool shared = k > 1 && name_at(k - 2) == "share";
      if (packages_.contains(name) || name.empty()) continue;
      if (shared || !guess_package(inside, urdf_).empty())
        refuse(urdf_.string(), missing + "; " + advice(name, inside));
    }
    refuse(urdf_.string(), missing);
  }

  static bool is_file(const std::filesystem::path& file) {
    std::error_code failed;
    return std::filesystem::is_regular_file(file, failed);
  }

  /// How to say where a package is.
  std::string advice(const std::string& name, const std::string& inside) const {
    const std::string likely = guess_package(inside, urdf_).string();
    return "--package " + sentence(name, 60) + "=" +
           (likely.empty() ? "FOLDER says where it is, as do ROS_PACKAGE_PATH and AMENT_PREFIX_PATH"
                           : sentence(likely, 120) + " would do, where " + sentence(inside, 60) + " is");
  }

  const std::filesystem::path urdf_;
  const folders& packages_;
  std::set<std::string> used_;
};

}  // namespace clearance::io
