// A Panda whose tool follows a circle: position before orientation before posture.
#include <cmath>
#include <cstdio>

#include <ahqp.hpp>

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const auto model = ahqp::Model::from_file(arguments[1]);  // panda.urdf
  const char* tool = "panda_hand_tcp";
  Eigen::VectorXd q(7);
  q << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785;
  ahqp::Ik ik(model);
  const auto position = ik.push_position("position", tool);
  ik.push_orientation("orientation", tool);
  ik.push_posture("posture");
  ik.build(q);  // orientation and posture stay as they are there
  const Eigen::Vector3d start = ik.pose(q, tool).first;
  for (int tick = 0; tick < 8000; ++tick) {
    const double angle = 1.57e-3 * tick;
    const Eigen::Vector3d shift(0.0, 0.1 * std::sin(angle), 0.1 * (std::cos(angle) - 1.0));
    ik.set_position(position, start + shift);
    ik.integrate(q, 1e-3);  // or ik.step(q, 1e-3, velocity), and velocity to the robot
  }
  for (const double joint : q) std::printf("%a\n", joint);
}
