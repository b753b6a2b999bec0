// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <clearance/io/error.hpp>
#include <clearance/io/xml.hpp>

#include <cstdlib>
#include <filesystem>
#include <map>
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

/// The file that a URDF means by package://name/path, model://name/path (a simulator's name for the same),
/// file:///path, or a path relative to the URDF's folder (file://path too). Throws std::runtime_error if the package is
/// not found, or for another scheme.
inline std::filesystem::path resolve_uri(const std::string& uri, const std::filesystem::path& urdf,
                                         const std::map<std::string, std::filesystem::path>& packages) {
  const std::size_t scheme = uri.find("://");
  if (uri.empty()) refuse(urdf.string(), "a mesh has an empty file name");
  if (scheme == uri.npos) return urdf.parent_path() / uri;
  if (uri.starts_with("file://")) return urdf.parent_path() / uri.substr(7);  // "file://a/b" is how some say a/b
  if (!uri.starts_with("package://") && !uri.starts_with("model://"))
    refuse(urdf.string(),
           io::quoted(uri) + " is none of package://name/path, model://name/path, file:///path and a relative path");
  std::string_view rest = std::string_view(uri).substr(scheme + 3);
  rest.remove_prefix(std::min(rest.find_first_not_of('/'), rest.size()));  // package:///name means package://name
  const std::string name(rest.substr(0, rest.find('/')));
  const std::string inside(rest.substr(std::min(name.size() + 1, rest.size())));
  if (name.empty() || inside.empty()) refuse(urdf.string(), io::quoted(uri) + " names no file in a package");
  const auto folders = find_package(name, urdf, packages);
  std::error_code failed;
  for (const auto& folder : folders)
    if (std::filesystem::exists(folder / inside, failed)) return folder / inside;
  if (!folders.empty()) return folders.front() / inside;  // the reader that opens it reports that it is missing
  const std::string likely = guess_package(inside, urdf).string();
  refuse(urdf.string(),
         "the package " + io::quoted(name) + " is not found: --package " + sentence(name, 60) + "=" +
             (likely.empty() ? "FOLDER says where it is, as do ROS_PACKAGE_PATH and AMENT_PREFIX_PATH"
                             : sentence(likely, 120) + " would do, where " + sentence(inside, 60) + " is"));
}

}  // namespace clearance::io
