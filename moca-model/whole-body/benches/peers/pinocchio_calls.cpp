// Times calls of Pinocchio in a loop of C++; run.py compiles and runs it.
//
//   pinocchio_calls MOCA_URDF HUMANOID_URDF
//
// Prints "call robot nanoseconds" a line: the median of 500 means over 100 calls, as in
// ../robot.rs, each from q on.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/model.hpp>
#include <pinocchio/algorithm/rnea.hpp>
#include <pinocchio/parsers/urdf.hpp>

namespace pin = pinocchio;

template <typename Call>
double median(Call call) {
    using Clock = std::chrono::steady_clock;
    for (int i = 0; i < 2000; ++i) call();
    std::vector<double> times;
    for (int sample = 0; sample < 500; ++sample) {
        const auto start = Clock::now();
        for (int i = 0; i < 100; ++i) call();
        const std::chrono::duration<double, std::nano> time = Clock::now() - start;
        times.push_back(time.count() / 100.0);
    }
    std::nth_element(times.begin(), times.begin() + 250, times.end());
    return times[250];
}

void time_calls(const std::string& name, const pin::Model& model,
                const std::vector<std::string>& names) {
    pin::Data data(model);
    Eigen::VectorXd v(model.nv);
    for (int i = 0; i < model.nv; ++i) v[i] = 0.3 + 0.05 * i;
    const Eigen::VectorXd q = pin::integrate(model, pin::neutral(model), v);
    pin::Data::Matrix6x jacobian = pin::Data::Matrix6x::Zero(6, model.nv);
    std::vector<pin::FrameIndex> frames;
    for (const auto& frame : names) frames.push_back(model.getFrameId(frame));

    const auto print = [&](const char* call, double time) {
        std::printf("%s %s %.1f\n", call, name.c_str(), time);
    };
    print("poses", median([&] { pin::forwardKinematics(model, data, q); }));
    const auto one_jacobian = [&] {
        jacobian.setZero();
        pin::computeFrameJacobian(model, data, q, frames[0], pin::LOCAL_WORLD_ALIGNED, jacobian);
        pin::updateFramePlacement(model, data, frames[0]);
    };
    print("poses_jacobian", median(one_jacobian));
    print("poses_jacobian_gravity", median([&] {
        one_jacobian();
        pin::computeGeneralizedGravity(model, data, q);
    }));
    print("placements_and_all_jacobians", median([&] {
        pin::computeJointJacobians(model, data, q);
        pin::updateFramePlacements(model, data);
        for (const auto frame : frames) {
            jacobian.setZero();
            pin::getFrameJacobian(model, data, frame, pin::LOCAL_WORLD_ALIGNED, jacobian);
        }
    }));
    print("inverse_dynamics", median([&] { pin::rnea(model, data, q, v, v); }));
    print("mass_matrix", median([&] { pin::crba(model, data, q); }));
    print("forward_dynamics", median([&] { pin::aba(model, data, q, v, v); }));
}

int main(int, char** arguments) {
    pin::Model full, moca, humanoid;
    pin::urdf::buildModel(arguments[1], full);
    const std::vector<pin::JointIndex> fingers = {
        full.getJointId("panda_finger_joint1"), full.getJointId("panda_finger_joint2")};
    pin::buildReducedModel(full, fingers, pin::neutral(full), moca);
    time_calls("Moca", moca, {"panda_tcp"});
    pin::urdf::buildModel(arguments[2], pin::JointModelFreeFlyer(), humanoid);
    time_calls("Humanoid", humanoid, {"left_sole", "right_sole", "left_palm", "right_palm"});
}
