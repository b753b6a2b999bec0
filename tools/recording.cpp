// SPDX-License-Identifier: BSD-3-Clause
#include "recording.hpp"

#include "command_line.hpp"

#include <clearance/io/cloud_file.hpp>
#include <clearance/io/cloud_text.hpp>
#include <clearance/io/error.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/io/text_file.hpp>
#include <clearance/questions/min_distances_per_part.hpp>
#include <clearance/questions/unseen.hpp>

#include <algorithm>
#include <filesystem>

using namespace clearance;

namespace {

namespace fs = std::filesystem;

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

constexpr const char* time_column = "time";

/// The words between commas; a word in quotes may have commas, and "" for a quote.
std::vector<std::string> words_of(std::string_view line) {
  std::vector<std::string> words;
  for (bool more = !trimmed(line).empty(); more;) {
    std::size_t comma = line.find(',');
    if (const std::size_t first = line.find_first_not_of(" \t"); first != line.npos && line[first] == '"') {
      std::string word;
      std::size_t at = first + 1;
      for (; at < line.size() && (line[at] != '"' || (at + 1 < line.size() && line[at + 1] == '"')); ++at) {
        word += line[at];
        at += line[at] == '"' ? 1 : 0;
      }
      comma = line.find(',', std::min(at, line.size()));
      const std::string_view after = line.substr(std::min(at + 1, line.size()));
      if (at < line.size() && trimmed(after.substr(0, after.find(','))).empty()) {
        words.push_back(word);
        more = comma != line.npos;
        line.remove_prefix(more ? comma + 1 : line.size());
        continue;
      }
      comma = line.find(',');
    }
    words.emplace_back(trimmed(line.substr(0, comma)));
    more = comma != line.npos;
    line.remove_prefix(more ? comma + 1 : line.size());
  }
  return words;
}

/// A line whose words are not in quotes.
std::string without_quotes(const std::string& line) {
  if (line.find('"') == line.npos) return line;
  std::string plain;
  for (const std::string& word : words_of(line)) plain += (plain.empty() ? "" : ",") + word;
  return plain;
}

/// The names in the first line. Each must be a joint that takes a value, named only once and not in `fixed`; and
/// "time", if `timed`.
std::vector<std::string> columns(const std::string& file, std::string_view line, const io::kinematic_tree& tree,
                                 const std::map<std::string, double>& fixed, bool timed) {
  std::vector<std::string> names;
  std::map<std::string, double> values = fixed;
  for (const std::string& name : words_of(line)) {
    if (io::printable(name) != name)  // a zero byte would end the sentence of whoever refuses it
      io::refuse(file, "has a column named " + io::quoted(name) + ", and no joint has such a name", 1);
    if (timed && name == time_column) {
      if (std::ranges::count(names, name)) io::refuse(file, "has two columns named time", 1);
      names.push_back(name);
      continue;
    }
    if (fixed.contains(name))
      io::refuse(file, "has a column for joint " + io::quoted(name) + ", which --joint gives too", 1);
    if (!values.emplace(name, 0).second) io::refuse(file, "has two columns for joint " + io::quoted(name), 1);
    names.push_back(name);
  }

  if (timed && !std::ranges::count(names, time_column))
    io::refuse(file, "has no column named time, which --stamps needs: when the joints were so, in seconds", 1);

  try {
    tree.configuration(values, {.ignore_limits = true});  // throws for an unknown name
  } catch (const std::invalid_argument& error) {
    io::refuse(file, error.what(), 1);
  }

  for (std::size_t i = 0; i < tree.size(); ++i)
    if (const std::string& name = tree.movable(i).name; !values.contains(name))
      io::refuse(file, "has no column for joint " + io::quoted(name) + " (--joint " + name + "=value fixes it)", 1);
  return names;
}

/// Refuses what is named like a frame and is no file; leaving it out would renumber those after it.
void check_frame(const std::string& file) {
  std::error_code failed;
  const fs::file_status status = fs::status(file, failed);
  if (fs::is_regular_file(status)) return;
  const bool linked = fs::is_symlink(fs::symlink_status(file, failed));
  const char* const what = fs::is_directory(status)        ? "is a folder"
                           : !fs::exists(status) && linked ? "is a link to what is not there"
                           : fs::exists(status)            ? "is no regular file"
                                                           : "cannot be read";
  io::refuse(file, std::string(what) + ", but is named like a frame of the recording");
}

/// Is it a single frame by its name? A .txt may be a list of frames.
bool is_frame(const std::string& file) {
  const std::string end = io::extension(file);
  return end == ".pcd" || end == ".ply" || end == ".xyz" || end == ".png";
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// By bytes, but numbers by their values: frame9 before frame10.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i;
      ++j;
      continue;
    }
    const auto take = [](const std::string& text, std::size_t& at) {
      while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1])) ++at;
      const std::size_t begin = at;
      while (at < text.size() && is_digit(text[at])) ++at;
      return std::string_view(text).substr(begin, at - begin);
    };
    const std::string_view x = take(a, i), y = take(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  const std::size_t rest = a.size() - i, others = b.size() - j;
  return rest != others ? rest < others : a < b;
}

}  // namespace

std::vector<std::string> list_frames(const std::string& where, std::vector<std::string>& notes) {
  std::vector<std::string> files, others;
  if (fs::is_directory(where)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(where)) {
      const std::string file = entry.path().string(), name = entry.path().filename().string();
      if (is_frame(file) || io::extension(file) == ".txt") {
        files.push_back(file);
        check_frame(file);
      } else if (std::error_code failed; !name.starts_with('.') && !entry.is_directory(failed)) {
        others.push_back(name);
      }
    }
    std::ranges::sort(files, comes_before);
    std::ranges::sort(others, comes_before);
    const std::size_t listed = files.size() + others.size();
    if (files.empty()) io::refuse(where, "has no frame: no file .pcd, .ply, .xyz, .txt or .png");
    if (!others.empty())
      notes.push_back(where + ": " + std::to_string(others.size()) + " of its " + std::to_string(listed) +
                      " files are not named like frames (.pcd, .ply, .xyz, .txt, .png) and are left out, " +
                      io::quoted(others[0]) + (others.size() > 1 ? " first" : ""));
    return files;
  }

  if (is_frame(where)) return {where};
  const std::string bytes = io::as_utf8(io::read_bytes(where), where);
  for (std::string_view rest = io::without_mark(bytes); !rest.empty();)
    if (const std::string_view path = trimmed(io::take_line(rest)); !path.empty()) {
      files.push_back((fs::path(where).parent_path() / path).string());
      if (files.size() == 1 && !fs::exists(files[0]) && io::number<double>(path.substr(0, path.find_first_of(" ,\t"))))
        io::refuse(where, "lists numbers, not frames: a file that is a frame itself must be named .xyz", 1);
    }
  if (files.empty()) io::refuse(where, "lists no frame");
  return files;
}

std::vector<std::string> joints_named(const query_options& asked) {
  std::vector<std::string> names;
  for (const auto& [name, value] : asked.joint) names.push_back(name);
  for (const std::string& file : {asked.recording.trajectory, asked.recording.plan, asked.configurations}) {
    if (file.empty()) continue;
    const std::string bytes = io::as_utf8(io::read_bytes(file), file);
    std::string_view rest = io::without_mark(bytes);
    std::ranges::copy(words_of(io::take_line(rest)), std::back_inserter(names));
  }
  return names;
}

std::vector<std::vector<double>> read_trajectory(const std::string& file, const io::kinematic_tree& tree,
                                                 const std::map<std::string, double>& fixed, io::joint_options limits,
                                                 std::vector<double>* times) {
  if (file.empty()) {
    for (std::size_t i = 0; i < tree.size(); ++i)
      if (const std::string& name = tree.movable(i).name; !fixed.contains(name))
        throw usage_error("--trajectory", "is needed, because joint " + io::quoted(name) +
                                              " has no value (--joint name=value fixes it)");
    return {tree.configuration(fixed, limits)};
  }

  const std::string bytes = io::as_utf8(io::read_bytes(file), file);
  std::string_view rest = io::without_mark(bytes);
  const std::vector<std::string> names = columns(file, io::take_line(rest), tree, fixed, times != nullptr);
  rest = rest.substr(0, rest.find_last_not_of(" \t\r\n") + 1);  // without blank lines at the end
  std::vector<std::vector<double>> rows;
  if (names.empty()) {
    if (!rest.empty()) io::refuse(file, "has values, but no names of joints", 2);
    return {tree.configuration(fixed, limits)};
  }

  for (std::size_t line = 2; !rest.empty(); ++line) {
    const std::string text(io::take_line(rest));
    const std::string where = file + ':' + std::to_string(line);
    const auto row = numbers(where, without_quotes(text), names.size(), "one a column");
    std::map<std::string, double> values = fixed;
    for (std::size_t i = 0; i < names.size(); ++i)
      times&& names[i] == time_column ? times->push_back(row[i]) : void(values[names[i]] = row[i]);
    try {
      rows.push_back(tree.configuration(values, limits));
    } catch (const std::invalid_argument& error) {
      io::refuse(file, error.what(), line);
    }
  }
  if (rows.empty()) io::refuse(file, "has no row");
  return rows;
}

std::vector<std::vector<double>> read_rows(const query_options& asked, const io::robot& robot,
                                           const std::string& file) {
  return read_trajectory(file, robot.kinematics(), {asked.joint.begin(), asked.joint.end()}, {asked.ignore_limits});
}

std::vector<stamped_row> read_stamped_rows(const query_options& asked, const io::robot& robot) {
  const recording_options& from = asked.recording;
  const io::kinematic_tree& tree = robot.kinematics();
  if (from.trajectory.empty()) throw usage_error("--stamps", "needs --trajectory, the joints and their times");
  std::vector<double> times;
  auto rows =
      read_trajectory(from.trajectory, tree, {asked.joint.begin(), asked.joint.end()}, {asked.ignore_limits}, &times);
  io::stamped_joints samples(tree, from.max_age);
  for (std::size_t k = 0; k < rows.size(); ++k) try {
      samples.add(times[k], std::move(rows[k]));
    } catch (const std::invalid_argument& error) {
      io::refuse(from.trajectory, error.what(), k + 2);
    }

  const std::string bytes = io::as_utf8(io::read_bytes(from.stamps), from.stamps);
  std::string_view rest = io::without_mark(bytes);
  rest = rest.substr(0, rest.find_last_not_of(" \t\r\n") + 1);  // without blank lines at the end
  std::vector<stamped_row> found;
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const double stamp = number(from.stamps + ':' + std::to_string(line), std::string(trimmed(io::take_line(rest))));
    try {
      found.push_back({stamp, samples.at_stamp(stamp)});
    } catch (const std::invalid_argument& error) {
      io::refuse(from.stamps, error.what(), line);
    }
    if (found.back().joints.off > 0 && (!asked.certain || asked.certain->speeds.empty()))
      io::refuse(from.stamps,
                 "the joints' only sample near the stamp " + std::to_string(stamp) + " s is " +
                     std::to_string(found.back().joints.off) + " s off: --joint-speed says how far they move in it",
                 line);
  }
  if (found.empty()) io::refuse(from.stamps, "has no line");
  return found;
}

placed_rows::placed_rows(const query_options& asked, const asked_robot& robot,
                         const std::vector<std::vector<double>>& rows, const std::string& file)
    : asked_(asked), robot_(robot), rows_(rows), file_(file) {
  constexpr std::size_t most = 1 << 20;  // poses
  rows_each_ = std::max<std::size_t>(1, most / (robot.description.parts().size() + robot.held.size()));
  first_ = placed(0);
}

std::vector<Eigen::Isometry3d> placed_rows::placed(std::size_t begin) const {
  std::vector<Eigen::Isometry3d> poses_of_rows;
  for (std::size_t k = begin; k < std::min(rows_.size(), begin + rows_each_); ++k) {
    const auto poses = placed_links(asked_, robot_, rows_[k], " in row " + std::to_string(k) + " of " + file_);
    if (k == begin) poses_of_rows.reserve(poses.size() * std::min(rows_.size() - begin, rows_each_));
    poses_of_rows.insert(poses_of_rows.end(), poses.begin(), poses.end());
  }
  return poses_of_rows;
}

void note_fields(const backend_robot& there, const std::vector<body>& bodies, std::vector<std::string>& notes) {
  for (std::size_t k = 0; k < there.without_field.size(); ++k)
    if (const std::string& why_not = there.without_field[k]; !why_not.empty())
      notes.push_back("--fields: link " + io::quoted(bodies[k].name) + ": " + why_not + "; so no field is used");
}

min_distances_result ask_plan(backend_robot& there, const placed_rows& rows, double d_max, double& query) {
  min_distances_result joined;
  rows.for_each_block([&](poses_of poses) {
    const min_distances_result some = there.plan(poses, d_max);
    joined.of.insert(joined.of.end(), some.of.begin(), some.of.end());
    query += there.query;
  });
  return joined;
}

std::vector<certain_row> ask_certain_plan(backend_robot& there, const placed_rows& rows, double d_max,
                                          const std::vector<double>& radii, double& query) {
  std::vector<certain_row> made;
  rows.for_each_block([&](poses_of poses) {
    const min_distances_per_part_result some = there.certain_plan(poses, d_max, radii);
    for (std::size_t c = 0; c < some.size(); ++c) {
      certain_row& row = made.emplace_back();
      row.anywhere = some.of(c)[0].dropped[int(drop_reason::too_close)];
      if (row.anywhere != 0) row.state = state::possible;  // if no other point is left, too
      for (std::uint32_t k = 0; k < some.parts; ++k) {
        const min_distance_result& r = some.of(c)[k];
        if (r.state == state::no_data || (row.part != none && !(r.lower < row.lower))) continue;
        row = {r.lower > 0 ? state::free : state::possible, r.lower, k, r.cloud, r.point, row.anywhere};
      }
    }
    query += there.query;
  });
  return made;
}

std::vector<unseen_result> ask_plan_unseen(backend_robot& there, const placed_rows& rows, const clearance::unseen& q,
                                           std::size_t links, bool until_end, double& query) {
  std::vector<unseen_result> made;
  rows.for_each_block([&](poses_of poses) {
    for (std::size_t first = 0; first < poses.size(); first += links) {
      made.push_back(there.unseen(poses.subspan(first, links), q, until_end));
      made.back().parts = {};  // a plan may have many rows
      query += there.query;
    }
  });
  return made;
}

void merged_cloud::add(observation frame, const Eigen::Isometry3d& carrier) {
  const Eigen::Isometry3d world = rigid(frame.world(carrier), "cloud", std::int64_t(frames_.size()));
  const seen_points seen = frame.seen(carrier, std::span(&world, 1));  // relative to the sensor, as its range is
  const io::cloud* const exact = frame.points();
  first_.push_back(points_.size());
  std::visit(
      [&](const auto& source) {
        sensors_.push_back({world.translation(), exact ? 0 : source.rounding().relative});
        for (std::size_t i = 0; i < source.size(); ++i) {
          const sample s = source[i];
          ++dropped_[int(s.dropped)];
          const Eigen::Vector3d p =
              exact ? exact->points[i] : Eigen::Vector3d(s.position.x, s.position.y, s.position.z);
          points_.push_back(s.valid() ? world * p : Eigen::Vector3d::Constant(not_a_number));
        }
      },
      seen.points);
  dropped_[int(drop_reason::not_finite)] -= frame.zeros;  // those made NaN were missing
  dropped_[int(drop_reason::missing)] += frame.zeros;
  frame.forget_points();
  frames_.push_back(std::move(frame));
}

seen_points merged_cloud::finish(const std::vector<Eigen::Isometry3d>& robot) {
  const std::size_t count = points_.size();
  cloud_ = io::make_cloud("merged", std::move(points_), count, 1).near(robot);
  // A point's distance from its sensor is at most the way by the origin, and the sensor's pose has moved it in double.
  position_error worst;
  for (const sensor& s : sensors_) {
    const double off = s.relative + frames::pose_error;
    worst.relative = std::max(worst.relative, off);
    worst.absolute = std::max(worst.absolute, off * (s.at - cloud_.origin).norm() + frames::pose_error * s.at.norm());
  }
  cloud_.off.relative += worst.relative;
  cloud_.off.absolute += worst.absolute;
  const auto [source, pose] = cloud_.view();
  return {source, pose};
}

std::pair<const observation*, std::uint32_t> merged_cloud::origin(std::uint32_t i) const {
  const auto after = std::upper_bound(first_.begin(), first_.end(), i);
  const std::size_t frame = std::size_t(after - first_.begin()) - 1;  // skips frames without points
  return {&frames_[frame], std::uint32_t(i - first_[frame])};
}

void merged_cloud::recount(min_distance_result& r) const {
  for (int k = 1; k < drop_reasons; ++k)
    if (k != int(drop_reason::cropped)) r.dropped[k] = dropped_[k];  // a crop is of the whole
}
