// SPDX-License-Identifier: BSD-3-Clause
#pragma once
// What packaging/ros2 uses of rclcpp, so that its node can be run where there is no ROS 2. Parameters come from the
// command line as name:=value; spin() is the test's own.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#define RCLCPP_WARN(logger, ...) (void(logger), void(std::fprintf(stderr, __VA_ARGS__)))
#define RCLCPP_FATAL(logger, ...) (void(logger), void(std::fprintf(stderr, __VA_ARGS__)))

namespace rclcpp {

struct QoS {
  explicit QoS(int) {}
  QoS& keep_last(int) { return *this; }
};
struct SensorDataQoS : QoS {
  SensorDataQoS() : QoS(5) {}
};
struct Duration {
  double seconds;
  static Duration from_seconds(double s) { return {s}; }
};
struct Logger {};
struct Clock {
  using SharedPtr = std::shared_ptr<Clock>;
};

inline std::map<std::string, std::string> parameters;
inline std::map<std::string, std::shared_ptr<void>> published;         // topic: all messages, a vector
inline std::map<std::string, std::function<void(const void*)>> heard;  // topic: what takes a shared pointer

template <class M>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  std::shared_ptr<std::vector<M>> all = std::make_shared<std::vector<M>>();
  void publish(const M& message) { all->push_back(message); }
};
template <class M>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
};

class Node {
 public:
  explicit Node(const std::string&) {}
  virtual ~Node() = default;

 protected:
  template <class T>
  T declare_parameter(const std::string& name, const T& otherwise) {
    const auto found = parameters.find(name);
    if (found == parameters.end()) return otherwise;
    if constexpr (std::is_same_v<T, std::string>)
      return found->second;
    else
      return T(std::atof(found->second.c_str()));
  }
  template <class M>
  typename Publisher<M>::SharedPtr create_publisher(const std::string& topic, const QoS&) {
    auto made = std::make_shared<Publisher<M>>();
    published[topic] = made->all;
    return made;
  }
  template <class M, class F>
  typename Subscription<M>::SharedPtr create_subscription(const std::string& topic, const QoS&, F f) {
    heard[topic] = [f](const void* m) { f(*static_cast<const std::shared_ptr<const M>*>(m)); };
    return std::make_shared<Subscription<M>>();
  }
  Clock::SharedPtr get_clock() { return std::make_shared<Clock>(); }
  Logger get_logger() const { return {}; }
};

inline Logger get_logger(const char*) { return {}; }
inline void init(int argc, char** argv) {
  for (int k = 1; k < argc; ++k) {
    const std::string word = argv[k];
    if (const auto at = word.find(":="); at != word.npos) parameters[word.substr(0, at)] = word.substr(at + 2);
  }
}
void spin(const std::shared_ptr<Node>& node);
inline void shutdown() {}

}  // namespace rclcpp
