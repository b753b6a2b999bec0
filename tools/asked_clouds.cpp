// SPDX-License-Identifier: BSD-3-Clause
#include "asked_clouds.hpp"

#include <clearance/io/kinematics.hpp>
#include <clearance/io/sentence.hpp>
#include "camera_checks.hpp"
#include "certain_report.hpp"

using namespace clearance;

void asked_clouds::load(const query_options& asked, progress& shown, std::vector<std::string>& notes) {
  check_image_sizes(asked.clouds);
  std::set<std::string> names;
  for (const cloud_options& from : asked.clouds) {
    shown.show("reading " + from.file);
    files.push_back(observe(from, names));
    notes.insert(notes.end(), files.back().notes.begin(), files.back().notes.end());
    note_camera(files.back(), notes);
  }
}

void asked_clouds::place(const query_options& asked, const asked_robot& robot, const std::vector<double>& joints,
                         poses_of poses, double off) {
  for (observation& cloud : files) {
    Eigen::Isometry3d carrier = Eigen::Isometry3d::Identity();
    if (const auto& link = cloud.from.link; !link.empty())
      carrier = about_file(asked.robot, [&] {
        return io::carried(asked.base, robot.description.link_pose(link, joints, {asked.ignore_limits}),
                           "link " + io::quoted(link));
      });
    carriers.push_back(carrier);
    seen.push_back(about_file(cloud.from.file, [&] {
      seen_points made = cloud.seen(carrier, poses);
      rigid(made.pose, "cloud");
      made.boxes = asked.where.seen_from(made.pose);
      made.off = carried_off(asked, robot, joints, cloud.from.link, carrier, made, off);
      return made;
    }));
  }
}

void asked_clouds::hide(std::span<const point_label> labels) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    hidden.push_back(files[i].hide(labels.first(files[i].size()), seen[i]));
    labels = labels.subspan(files[i].size());
  }
}
