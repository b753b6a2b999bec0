// SPDX-License-Identifier: BSD-3-Clause
// How far a robot is from what its sensors see: PointCloud2 or depth Image in, Clearance and Range out.
//
//   ros2 run clearance_ros clearance_node --ros-args -p urdf:=arm.urdf -p cloud:=/lidar/points
//
// robot_state_publisher places the robot: each link with geometry is a frame of TF. What cannot be asked is UNKNOWN,
// with a note, and a lower end of 0. Untried with a real ROS 2.
#include <clearance/backends/host.hpp>
#include <clearance/io/robot.hpp>
#include <clearance/make_model.hpp>
#include <clearance/packing/pack.hpp>
#include <clearance/points/camera.hpp>
#include <clearance/points/point_cloud2.hpp>
#include <clearance/questions/min_distance.hpp>
#include <clearance/volume/sphere.hpp>

#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>
#include <clearance_msgs/msg/clearance.hpp>
#include <rclcpp/rclcpp.hpp>
#include <sensor_msgs/msg/camera_info.hpp>
#include <sensor_msgs/msg/image.hpp>
#include <sensor_msgs/msg/point_cloud2.hpp>
#include <sensor_msgs/msg/range.hpp>
#include <tf2_eigen/tf2_eigen.hpp>

#include <ranges>

namespace {

using clearance_msgs::msg::Clearance;
using sensor_msgs::msg::CameraInfo, sensor_msgs::msg::Image, sensor_msgs::msg::PointCloud2, sensor_msgs::msg::Range;
using question = clearance::min_distance_per_part;

auto packed_model(const clearance::io::robot& robot, std::int64_t spheres) {
  if (spheres < 1) throw std::invalid_argument("spheres is " + std::to_string(spheres) + "; it is 1 or more");
  const auto& parts = robot.parts();
  const auto packed =
      clearance::pack(parts | std::views::transform(&clearance::io::robot_part::mesh), {.count = std::size_t(spheres)});
  return clearance::make_model<clearance::sphere>(
      packed, [&](std::size_t k) { return clearance::part_options{.tolerance = parts[k].tessellation_error}; });
}

/// The camera of the last CameraInfo, and its rays.
struct seen_by {
  CameraInfo::ConstSharedPtr info;
  clearance::ray_table rays;

  explicit seen_by(const CameraInfo::ConstSharedPtr& from) : info(from) {
    const auto& roi = info->roi;
    rays = clearance::camera({.width = info->width,
                              .height = info->height,
                              .distortion_model = info->distortion_model,
                              .d = info->d,
                              .k = info->k,
                              .binning_x = info->binning_x,
                              .binning_y = info->binning_y,
                              .roi = {roi.x_offset, roi.y_offset, roi.width, roi.height}})
               .rays();
  }
  bool holds(const CameraInfo& other) const {
    return info->width == other.width && info->height == other.height && info->k == other.k && info->d == other.d &&
           info->distortion_model == other.distortion_model && info->roi == other.roi &&
           info->binning_x == other.binning_x && info->binning_y == other.binning_y;
  }
};

class clearance_node : public rclcpp::Node {
 public:
  clearance_node()
      : Node("clearance"),
        base_(declare_parameter<std::string>("base_frame", "base_link")),
        wait_(rclcpp::Duration::from_seconds(declare_parameter<double>("wait", 0.05))),
        robot_(clearance::io::load_robot(declare_parameter<std::string>("urdf", ""))),
        model_(packed_model(robot_, declare_parameter<std::int64_t>("spheres", 2048))),
        ask_(clearance::host{}, model_, question{}),
        transforms_(get_clock()),
        listener_(transforms_) {
    for (const std::string& note : robot_.notes()) RCLCPP_WARN(get_logger(), "%s", note.c_str());
    const auto cloud = declare_parameter<std::string>("cloud", ""), image = declare_parameter<std::string>("image", "");
    if (cloud.empty() == image.empty()) throw std::invalid_argument("say one topic: cloud or image");
    said_ = create_publisher<Clearance>("~/clearance", rclcpp::QoS(5));
    range_ = create_publisher<Range>("~/range", rclcpp::QoS(5));
    topic_ = cloud.empty() ? image : cloud;
    const auto newest = rclcpp::SensorDataQoS().keep_last(1);
    if (image.empty()) {
      clouds_ = create_subscription<PointCloud2>(cloud, newest, [this](PointCloud2::ConstSharedPtr m) { take(*m); });
      return;
    }
    const auto beside = image.substr(0, image.rfind('/') + 1) + "camera_info";
    images_ = create_subscription<Image>(image, newest, [this](Image::ConstSharedPtr m) { take(*m); });
    infos_ = create_subscription<CameraInfo>(declare_parameter<std::string>("camera_info", beside), newest,
                                             [this](CameraInfo::ConstSharedPtr m) { info_ = m; });
  }

 private:
  void take(const PointCloud2& message) {
    answer(message.header, [&](const auto& poses, const Eigen::Isometry3d& sensor) {
      const bool in_double = std::ranges::any_of(message.fields, [](const auto& field) {
        return field.name == "x" && field.datatype == clearance::point_field::float64;
      });
      return in_double ? ask_(poses, clearance::point_cloud2_view<double>(message), sensor)
                       : ask_(poses, clearance::point_cloud2_view(message), sensor);
    });
  }

  void take(const Image& message) {
    answer(message.header, [&](const auto& poses, const Eigen::Isometry3d& sensor) {
      if (message.is_bigendian) throw std::invalid_argument("the image is big-endian");
      if (!info_) throw std::invalid_argument("no CameraInfo was heard yet");
      if (!camera_ || !camera_->holds(*info_)) camera_.emplace(info_);
      if (message.encoding == "16UC1" || message.encoding == "mono16")
        return ask_(poses, pixels<std::uint16_t>(message), sensor);
      if (message.encoding == "32FC1") return ask_(poses, pixels<float>(message), sensor);
      throw std::invalid_argument("the image is encoded as " + message.encoding + ", which is no depth");
    });
  }

  template <class Pixel>
  clearance::ray_image<Pixel> pixels(const Image& message) const {
    const auto step =
        clearance::row_step(message.height, message.width * sizeof(Pixel), message.step, message.data.size());
    if (!step) throw std::invalid_argument("the image has other bytes than its size and step say");
    if (*step % sizeof(Pixel) != 0) throw std::invalid_argument("the image's rows end within a pixel");
    const std::span all(reinterpret_cast<const Pixel*>(message.data.data()), message.data.size() / sizeof(Pixel));
    return camera_->rays.image(all, message.width, message.height, *step / sizeof(Pixel));
  }

  Eigen::Isometry3d placed(const std::string& frame, const std_msgs::msg::Header& header) {
    return tf2::transformToEigen(transforms_.lookupTransform(base_, frame, header.stamp, wait_));
  }

  template <class Ask>
  void answer(const std_msgs::msg::Header& header, Ask ask) {
    Clearance out;
    out.header.stamp = header.stamp, out.header.frame_id = base_;
    out.topic = topic_, out.sensor_frame = header.frame_id;
    out.state = Clearance::UNKNOWN, out.point = Clearance::NO_POINT;
    out.distance = std::numeric_limits<double>::quiet_NaN();
    out.lower = 0, out.upper = std::numeric_limits<double>::infinity();
    try {
      std::vector<Eigen::Isometry3d> poses;
      for (const auto& part : robot_.parts()) poses.push_back(placed(part.name, header));
      write(ask(poses, placed(header.frame_id, header)), out);
    } catch (const std::exception& error) {  // a transform that is missing, or a message that contradicts itself
      out.note = error.what();
    }
    said_->publish(out);

    Range range;
    range.header = out.header, range.radiation_type = Range::INFRARED, range.max_range = 1000;
    const bool known = out.state != Clearance::UNKNOWN && out.state != Clearance::NO_DATA;
    range.range = known ? float(out.lower) : -std::numeric_limits<float>::infinity();  // REP 117: too near
    range_->publish(range);
  }

  void write(const clearance::min_distance_per_part_result& found, Clearance& out) const {
    constexpr std::uint8_t states[] = {Clearance::FREE, Clearance::POSSIBLE, Clearance::COLLISION, Clearance::NO_DATA};
    constexpr const char* reasons[] = {"",       "not_finite", "missing", "saturated", "out_of_range",
                                       "masked", "too_close",  "cropped"};
    static_assert(std::size(reasons) == clearance::drop_reasons);
    const clearance::min_distance_result& r = found.all;
    out.state = states[int(r.state)], out.distance = r.distance, out.lower = r.lower, out.upper = r.upper;
    out.seen = r.seen, out.valid = r.valid;
    if (r.point != clearance::none) {
      out.point = r.point, out.link = robot_.parts()[r.part].name;
      out.at.x = r.at.x, out.at.y = r.at.y, out.at.z = r.at.z;
      out.nearest.x = r.nearest.x, out.nearest.y = r.nearest.y, out.nearest.z = r.nearest.z;
    }
    for (int k = 1; k < clearance::drop_reasons; ++k) {
      if (r.dropped[k] == 0) continue;
      auto& one = out.dropped.emplace_back();
      one.reason = reasons[k], one.count = r.dropped[k];
    }
    for (std::size_t k = 0; k < found.parts.size(); ++k) {
      auto& one = out.parts.emplace_back();
      one.link = robot_.parts()[k].name, one.distance = found.parts[k].distance;
    }
  }

  std::string base_, topic_;
  rclcpp::Duration wait_;
  clearance::io::robot robot_;
  using model = decltype(packed_model(robot_, 0));
  model model_;
  decltype(clearance::query(clearance::host{}, std::declval<const model&>(), question{})) ask_;
  tf2_ros::Buffer transforms_;
  tf2_ros::TransformListener listener_;
  CameraInfo::ConstSharedPtr info_;
  std::optional<seen_by> camera_;
  rclcpp::Publisher<Clearance>::SharedPtr said_;
  rclcpp::Publisher<Range>::SharedPtr range_;
  rclcpp::Subscription<PointCloud2>::SharedPtr clouds_;
  rclcpp::Subscription<Image>::SharedPtr images_;
  rclcpp::Subscription<CameraInfo>::SharedPtr infos_;
};

}  // namespace

int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  try {
    rclcpp::spin(std::make_shared<clearance_node>());
  } catch (const std::exception& error) {
    RCLCPP_FATAL(rclcpp::get_logger("clearance"), "%s", error.what());
    return 1;
  }
  rclcpp::shutdown();
  return 0;
}
