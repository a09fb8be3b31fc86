// What a controller manager does, on a simulated Panda: configure, activate, update, deactivate.
#include <cmath>
#include <cstdio>
#include <limits>

#include "tool_controller.hpp"

namespace ci = controller_interface;

int main(int count, char** arguments) {
  if (count < 2) return 2;
  std::vector<std::string> joints;
  for (int joint = 1; joint <= 7; ++joint) joints.push_back("panda_joint" + std::to_string(joint));
  ToolController controller(arguments[1], "panda_hand_tcp", joints);
  std::vector<double> position{0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785}, command(7, 0.0);
  for (auto& value : position) controller.state_interfaces_.emplace_back(&value);
  for (auto& value : command) controller.command_interfaces_.emplace_back(&value);

  const rclcpp_lifecycle::State state;
  const double period = 1e-3;
  bool is_right = controller.on_init() == ci::CallbackReturn::SUCCESS &&
                  controller.command_interface_configuration().names.back() == "panda_joint7/velocity" &&
                  controller.on_configure(state) == ci::CallbackReturn::SUCCESS &&
                  controller.on_activate(state) == ci::CallbackReturn::SUCCESS;
  if (!is_right) return 1;
  const Eigen::Vector3d goal = controller.target() + Eigen::Vector3d(0.0, 0.15, 0.1);
  controller.set_target(goal);
  for (int tick = 0; tick < 3000; ++tick) {
    is_right &= controller.update({tick * period}, {period}) == ci::return_type::OK;
    for (std::size_t joint = 0; joint < 7; ++joint) position[joint] += command[joint] * period;
  }
  // The tool is there, by kinematics of its own.
  const auto model = ahqp::Model::from_file(arguments[1]);
  ahqp::Ik ik(model);
  ik.push_posture("posture");
  const Eigen::VectorXd q = Eigen::Map<Eigen::VectorXd>(position.data(), 7);
  ik.build(q);
  const double error = (ik.pose(q, "panda_hand_tcp").first - goal).norm();
  std::printf("the tool is %.1e m from its goal\n", error);
  is_right &= error < 1e-6;
  // A sensor fails: the robot brakes, and the controller says so.
  position[3] = std::numeric_limits<double>::quiet_NaN();
  is_right &= controller.update({3.0}, {period}) == ci::return_type::ERROR;
  for (const double velocity : command) is_right &= std::isfinite(velocity);
  controller.on_deactivate(state);
  for (const double velocity : command) is_right &= velocity == 0.0;
  return is_right ? 0 : 1;
}
