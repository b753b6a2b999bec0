// SPDX-License-Identifier: BSD-3-Clause
#include <clearance/io/spheres_file.hpp>

#include <clearance/io/cloud_text.hpp>
#include <clearance/io/ist.hpp>
#include <clearance/io/packed_part.hpp>
#include <clearance/io/text_file.hpp>
#include <clearance/io/write_file.hpp>

#include <filesystem>
#include <span>

namespace clearance::io {

packing load_spheres_csv(const std::string& file) {
  constexpr std::string_view separators = " \t\r\v\f,;";
  const std::string bytes = read_text(file);
  std::string_view rest = without_mark(bytes);
  std::vector<inner_sphere> spheres;
  bool header_may_come = true;

  for (std::size_t at = 1; !rest.empty(); ++at) {
    std::string_view line = take_line(rest);
    line = without_comment(line, separators);
    std::vector<std::string_view> fields;
    for (auto word = take_word(line, separators); !word.empty(); word = take_word(line, separators))
      fields.push_back(word);
    if (fields.empty()) continue;

    if (header_may_come)
      for (auto& name : fields)
        if (name.size() > 1 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
    const bool header = header_may_come && !number<double>(fields[0]);
    header_may_come = false;
    if (header) {
      if (fields.size() != 4 || fields[0] != "x" || fields[1] != "y" || fields[2] != "z" ||
          (fields[3] != "r" && fields[3] != "radius"))
        refuse(file, "the header is not x,y,z,r", at);
      continue;
    }

    if (fields.size() != 4)
      refuse(file, "a sphere needs four numbers, x,y,z,r; here are " + std::to_string(fields.size()), at);
    float n[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto value = number<float>(fields[k]);
      if (!value) refuse(file, io::quoted(fields[k]) + " is not a number", at);
      n[k] = *value;
    }
    spheres.push_back(checked_sphere({n[0], n[1], n[2]}, n[3], file, "the sphere", at));
  }
  if (spheres.empty()) refuse(file, "has no sphere");
  return uncertified(std::move(spheres));
}

void save_spheres_csv(std::span<const inner_sphere> spheres, const std::string& file) {
  std::string text = "x,y,z,r\n";
  for (const inner_sphere& s : spheres)
    text += shortest(s.center.x) + ',' + shortest(s.center.y) + ',' + shortest(s.center.z) + ',' + shortest(s.radius) +
            '\n';
  write_bytes(file, text);
}

std::string spheres_format(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  return ending == ".ist" ? "ist" : ending == ".csv" ? "csv" : ending == ".yaml" || ending == ".yml" ? "yaml" : "";
}

std::vector<packed_part> load_spheres(const std::string& file, const mesh_limits& limits,
                                      std::vector<std::string>* notes) {
  const std::string format = spheres_format(file);
  if (format == "ist") return load_ist(file);
  if (format == "yaml") return load_spheres_yaml(file, limits, notes);
  if (format != "csv") refuse(file, "spheres are read from .ist, .csv, .yaml and .yml files");
  std::vector<packed_part> parts(1);
  parts[0].name = std::filesystem::path(file).stem().string();
  parts[0].spheres = load_spheres_csv(file);
  return parts;
}

void save_spheres(std::span<const packed_part> parts, const std::string& file) {
  const std::string format = spheres_format(file);
  if (format == "ist") return save_ist(parts, file);
  if (format == "yaml") return save_spheres_yaml(parts, file);
  if (format != "csv") refuse(file, "spheres are written to .ist, .csv, .yaml and .yml files");
  if (parts.size() != 1)
    refuse(file, "a CSV file holds the spheres of one part, here are " + std::to_string(parts.size()) +
                     ": take .ist or .yaml");
  save_spheres_csv(parts[0].spheres.spheres, file);
}

}  // namespace clearance::io
