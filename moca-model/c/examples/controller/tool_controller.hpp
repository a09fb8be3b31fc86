// A controller in the shape that ros2_control wants: it holds a tool's orientation and takes its position to
// a point, by velocities of the joints. update() throws nothing, and allocates nothing while measurements are sound.

#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <ahqp.hpp>

#include "controller_interface.hpp"

class ToolController : public controller_interface::ControllerInterface {
 public:
  // What parameters give in ROS 2.
  ToolController(std::string urdf, std::string frame, std::vector<std::string> joints)
      : urdf_(std::move(urdf)), frame_(std::move(frame)), joints_(std::move(joints)) {}

  controller_interface::CallbackReturn on_init() override { return controller_interface::CallbackReturn::SUCCESS; }

  controller_interface::InterfaceConfiguration command_interface_configuration() const override {
    return interfaces("/velocity");
  }

  controller_interface::InterfaceConfiguration state_interface_configuration() const override {
    return interfaces("/position");
  }

  controller_interface::CallbackReturn on_configure(const rclcpp_lifecycle::State&) override try {
    model_ = std::make_unique<ahqp::Model>(ahqp::Model::from_file(urdf_));
    if (model_->position_count() != joints_.size()) return controller_interface::CallbackReturn::FAILURE;
    q_ = model_->neutral();
    velocity_ = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(model_->velocity_count()));
    return controller_interface::CallbackReturn::SUCCESS;
  } catch (const ahqp::Error&) {
    return controller_interface::CallbackReturn::FAILURE;
  }

  controller_interface::CallbackReturn on_activate(const rclcpp_lifecycle::State&) override try {
    read();
    ik_ = std::make_unique<ahqp::Ik>(*model_);
    position_ = ik_->push_position("position", frame_.c_str());
    ik_->push_orientation("orientation", frame_.c_str());
    ik_->push_posture("posture");
    ik_->build(q_);
    target_ = ik_->pose(q_, frame_.c_str()).first;
    return controller_interface::CallbackReturn::SUCCESS;
  } catch (const ahqp::Error&) {
    return controller_interface::CallbackReturn::FAILURE;
  }

  controller_interface::CallbackReturn on_deactivate(const rclcpp_lifecycle::State&) override {
    for (auto& command : command_interfaces_) command.set_value(0.0);
    ik_.reset();
    return controller_interface::CallbackReturn::SUCCESS;
  }

  controller_interface::return_type update(const rclcpp::Time&, const rclcpp::Duration& period) override {
    read();
    auto result = controller_interface::return_type::OK;
    try {
      ik_->set_position(position_, target_);
      ik_->step(q_, period.seconds(), velocity_);
    } catch (const ahqp::Error&) {
      result = brake(period.seconds());
    }
    for (std::size_t joint = 0; joint < command_interfaces_.size(); ++joint)
      command_interfaces_[joint].set_value(velocity_[static_cast<Eigen::Index>(joint)]);
    return result;
  }

  // Where the tool is to go, in the world [m].
  void set_target(const Eigen::Vector3d& target) { target_ = target; }
  const Eigen::Vector3d& target() const { return target_; }

 private:
  controller_interface::InterfaceConfiguration interfaces(const char* kind) const {
    std::vector<std::string> names;
    for (const auto& joint : joints_) names.push_back(joint + kind);
    return {controller_interface::interface_configuration_type::INDIVIDUAL, names};
  }

  void read() {
    for (std::size_t joint = 0; joint < state_interfaces_.size(); ++joint)
      q_[static_cast<Eigen::Index>(joint)] = state_interfaces_[joint].get_value();
  }

  // Bad measurements: the robot stops within its limits, or at once where the period is none.
  controller_interface::return_type brake(double period) {
    try {
      ik_->brake(period, velocity_);
    } catch (const ahqp::Error&) {
      velocity_.setZero();
    }
    return controller_interface::return_type::ERROR;
  }

  std::string urdf_, frame_;
  std::vector<std::string> joints_;
  std::unique_ptr<ahqp::Model> model_;
  std::unique_ptr<ahqp::Ik> ik_;
  std::size_t position_ = 0;
  Eigen::VectorXd q_, velocity_;
  Eigen::Vector3d target_ = Eigen::Vector3d::Zero();
};
