// The shape of ros2_control's ControllerInterface, as far as the example needs it: with ROS 2 installed,
// include <controller_interface/controller_interface.hpp> in place of this file.

#pragma once

#include <string>
#include <vector>

namespace rclcpp {
struct Time {
  double seconds;
};
struct Duration {
  double value;
  double seconds() const { return value; }
};
}  // namespace rclcpp

namespace rclcpp_lifecycle {
struct State {};
}  // namespace rclcpp_lifecycle

namespace controller_interface {

enum class return_type { OK, ERROR };
enum class CallbackReturn { SUCCESS, FAILURE, ERROR };
enum class interface_configuration_type { ALL, INDIVIDUAL, NONE };

struct InterfaceConfiguration {
  interface_configuration_type type;
  std::vector<std::string> names;
};

class LoanedInterface {
 public:
  explicit LoanedInterface(double* value) : value_(value) {}
  double get_value() const { return *value_; }
  void set_value(double value) { *value_ = value; }

 private:
  double* value_;
};

class ControllerInterface {
 public:
  virtual ~ControllerInterface() = default;
  virtual CallbackReturn on_init() = 0;
  virtual InterfaceConfiguration command_interface_configuration() const = 0;
  virtual InterfaceConfiguration state_interface_configuration() const = 0;
  virtual CallbackReturn on_configure(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_activate(const rclcpp_lifecycle::State&) = 0;
  virtual CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) = 0;
  virtual return_type update(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

  std::vector<LoanedInterface> command_interfaces_;
  std::vector<LoanedInterface> state_interfaces_;
};

}  // namespace controller_interface
