// SPDX-License-Identifier: BSD-3-Clause
// Says a few frames to the node of packaging/ros2, and prints what it published.
#include <tf2_ros/buffer.h>
#include <clearance_msgs/msg/clearance.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <sensor_msgs/msg/range.hpp>

#include <cmath>
#include <cstring>

namespace {

using clearance_msgs::msg::Clearance;
using sensor_msgs::msg::CameraInfo, sensor_msgs::msg::Image, sensor_msgs::msg::PointCloud2, sensor_msgs::msg::Range;

template <class M>
void say(const std::string& topic, const M& message) {
  const std::shared_ptr<const M> shared = std::make_shared<M>(message);
  rclcpp::heard.at(topic)(&shared);
}

PointCloud2 cloud(const std::string& frame) {
  PointCloud2 m;
  m.header.frame_id = frame, m.header.stamp.sec = 7;
  m.height = 1, m.width = 3, m.point_step = 16, m.row_step = 48;
  for (std::uint32_t k = 0; k < 3; ++k) {
    auto& field = m.fields.emplace_back();
    field.name = std::string(1, "xyz"[k]), field.offset = 4 * k, field.datatype = 7, field.count = 1;
  }
  const float points[3][4] = {{0, 0, 3, 0}, {0, 0.5f, 1, 0}, {0, 0, NAN, 0}};
  m.data.resize(48);
  std::memcpy(m.data.data(), points, 48);
  return m;
}

Image image(std::uint32_t width) {
  Image m;
  m.header.frame_id = "lens", m.encoding = "16UC1";
  m.height = 4, m.width = width, m.step = 2 * width + 4;  // padded rows
  std::vector<std::uint16_t> pixels((width + 2) * 4, 0);
  pixels[(width + 2) * 2 + 3] = 2000;  // column 3, row 2
  m.data.resize(2 * pixels.size());
  std::memcpy(m.data.data(), pixels.data(), m.data.size());
  return m;
}

}  // namespace

void rclcpp::spin(const std::shared_ptr<Node>&) {
  Eigen::Isometry3d lens = Eigen::Isometry3d::Identity();
  lens.translation().z() = 0.5;
  tf2_ros::placed = {{"ball", Eigen::Isometry3d::Identity()}, {"lens", lens}};
  if (heard.contains("/cloud")) {
    say("/cloud", cloud("lens"));
    say("/cloud", cloud("nowhere"));
  } else {
    say("/depth/image", image(8));
    CameraInfo info;
    info.width = 8, info.height = 4, info.distortion_model = "plumb_bob", info.d = {0, 0, 0, 0, 0};
    info.k = {10, 0, 3, 0, 10, 2, 0, 0, 1};
    say("/depth/camera_info", info);
    say("/depth/image", image(8));
    say("/depth/image", image(6));
  }
  const auto& all = *std::static_pointer_cast<std::vector<Clearance>>(published.at("~/clearance"));
  const auto& ranges = *std::static_pointer_cast<std::vector<Range>>(published.at("~/range"));
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Clearance& c = all[k];
    std::printf("%d %.9g %.9g %.9g %s %u %u %u %zu %.9g %.9g %s|%s\n", c.state, c.distance, c.lower, c.upper,
                c.link.empty() ? "-" : c.link.c_str(), c.point, unsigned(c.seen), unsigned(c.valid), c.dropped.size(),
                c.parts.empty() ? NAN : c.parts[0].distance, double(ranges[k].range), c.topic.c_str(), c.note.c_str());
  }
}
