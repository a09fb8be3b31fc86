// Whatever C++ passes, the answer is an exception or a status with a text, and layouts do not matter.
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

#include <ahqp.hpp>

static int failures = 0;

static void expect(bool holds, const char* what) {
  if (!holds) {
    std::fprintf(stderr, "failed: %s; last error: %s\n", what, ahqp_last_error());
    ++failures;
  }
}

// Runs what must throw, with this status and these words.
template <typename Run>
static void expect_error(AhqpStatus status, const std::string& words, Run run) {
  try {
    run();
    expect(false, words.c_str());
  } catch (const ahqp::Error& error) {
    const std::string text = error.what();
    expect(error.status() == status && text.find(words) != std::string::npos, (words + " in: " + text).c_str());
  }
}

int main(int count, char** arguments) {
  if (count < 2) return 2;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  using Row = Eigen::RowVector2d;
  using One = Eigen::Matrix<double, 1, 1>;
  const One one(1.0), two(2.0);

  ahqp::Hierarchy hierarchy(2);
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "3, but 2", [&] { hierarchy.push(Eigen::RowVector3d::Ones(), one, one); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "the lower bound has size 2",
               [&] { hierarchy.push(Row::Ones(), Eigen::Vector2d::Ones(), one); });
  expect_error(AHQP_STATUS_NULL_POINTER, "A is null", [&] { hierarchy.push(Eigen::MatrixXd(), one, one); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "4096 at most", [] { ahqp::Hierarchy(std::size_t(1) << 60); });
  expect_error(AHQP_STATUS_BAD_DATA, "no variables", [] { ahqp::Hierarchy(0); });

  // Rows and columns of larger matrices, in both orders, are read in place.
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> by_rows = Eigen::Matrix4d::Random();
  Eigen::Matrix4d by_columns = by_rows;
  const Eigen::Vector2d target(1.0, 2.0);
  ahqp::Hierarchy left(2), right(2);
  left.push(by_rows.block(1, 1, 2, 2), target, target);
  right.push(by_columns.block(1, 1, 2, 2), target, target);
  Eigen::VectorXd x(2), y(2);
  ahqp::Solver solver(left);
  expect(solver.solve(left, x) == AHQP_STATUS_OK && solver.iterations() > 0, "a solve");
  expect(ahqp::Solver(right).solve(right, y) == AHQP_STATUS_OK && x == y, "both orders");
  expect(ahqp::Matrix(by_rows.block(1, 1, 2, 2)).view().data == &by_rows(1, 1), "rows in place");
  expect(ahqp::Matrix(by_columns.block(1, 1, 2, 2)).view().data == &by_columns(1, 1), "columns in place");
  expect((by_rows.block(1, 1, 2, 2) * x - target).norm() < 1e-9, "the target");
  expect(left.violation(0, x) < 1e-9, "the violation");
  left.set_bounds(0, 2.0 * target, 2.0 * target);
  solver.solve(left, y);
  expect((y - 2.0 * x).norm() < 1e-9, "new bounds");

  using Strides = Eigen::Stride<Eigen::Dynamic, Eigen::Dynamic>;
  const Eigen::Map<Eigen::MatrixXd, 0, Strides> backwards(&by_columns(1, 1), 2, 2, Strides(-4, 1));
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "strides", [&] { left.set_matrix(0, backwards); });
  Eigen::VectorXd small(1);
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "x has size 1", [&] { solver.solve(left, small); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "time is -1", [&] { solver.solve(left, x, 0, -1.0); });
  expect_error(AHQP_STATUS_BAD_DATA, "not finite", [&] {
    left.set_matrix(0, Eigen::Matrix2d::Constant(nan));
    solver.solve(left, x);
  });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "no level 7", [&] { left.set_weights(7, one); });
  expect_error(AHQP_STATUS_BAD_DATA, "weight", [&] { left.set_weights(0, Eigen::Vector2d(-1.0, 1.0)); });

  ahqp::Hierarchy conflict(1);
  conflict.set_bounds(one, one);
  conflict.push_hard(one, two, two, "far");
  try {
    ahqp::Solver(conflict).solve(conflict, small);
    expect(false, "a conflict");
  } catch (const ahqp::InfeasibleError& error) {
    expect(error.conflict().size() == 2 && error.conflict()[0] == "constraint row 0 of level 0 \"far\"", "the rows");
  }

  expect_error(AHQP_STATUS_BAD_DATA, "nowhere", [] { ahqp::Model::from_file("nowhere.urdf"); });
  expect_error(AHQP_STATUS_BAD_DATA, "line 1", [] { ahqp::Model::from_urdf("<robot"); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "base is 9",
               [&] { ahqp::Model::from_file(arguments[1], static_cast<AhqpBase>(9)); });
  const auto model = ahqp::Model::from_file(arguments[1]);
  Eigen::VectorXd q = model.neutral(), velocity(model.velocity_count());
  expect(q.norm() == 0.0, "the neutral configuration");
  q << 0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785;
  ahqp::Ik ik(model);
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "not built", [&] { ik.step(q, 1e-3, velocity); });
  expect_error(AHQP_STATUS_BAD_DATA, "panda_hand", [&] { ik.push_frame("tool", "hand"); });
  const auto tool = ik.push_frame("tool", "panda_hand_tcp");
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "q has size 1", [&] { ik.build(one); });
  ik.build(q);
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "built already", [&] { ik.push_posture("late"); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "no posture task", [&] { ik.set_posture(tool, q); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "norm",
               [&] { ik.set_pose(tool, Eigen::Vector3d::Zero(), Eigen::Quaterniond(2.0, 0.0, 0.0, 0.0)); });
  expect_error(AHQP_STATUS_BAD_DATA, "positive", [&] { ik.step(q, 0.0, velocity); });
  expect_error(AHQP_STATUS_BAD_ARGUMENT, "the velocity has size 1", [&] { ik.step(q, 1e-3, small); });
  expect_error(AHQP_STATUS_BAD_DATA, "NaN", [&] { ik.step(Eigen::VectorXd::Constant(q.size(), nan), 1e-3, velocity); });
  const auto [position, orientation] = ik.pose(q, "panda_hand_tcp");
  ik.set_pose(tool, position, orientation);
  expect(ik.step(q, 1e-3, velocity) == AHQP_STATUS_OK && velocity.norm() < 1e-9, "a pose that is held");
  ik.reset(Eigen::VectorXd::Constant(q.size(), 0.1));
  ik.brake(1e-3, velocity);
  expect(velocity.norm() < 0.1 * std::sqrt(7.0), "a brake");

  // Null handles, as only C has them.
  expect(ahqp_solver_solve(nullptr, nullptr, 0, 0.0, nullptr, 0) == AHQP_STATUS_NULL_POINTER, "a null solver");
  expect(ahqp_hierarchy_new(1, nullptr) == AHQP_STATUS_NULL_POINTER, "nowhere to put a handle");
  expect(ahqp_solver_iterations(nullptr) == 0 && ahqp_model_position_count(nullptr) == 0, "counts of nothing");
  ahqp_solver_free(nullptr);
  return failures == 0 ? 0 : 1;
}
