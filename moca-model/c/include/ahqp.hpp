// Strict priorities for robots in C++17: a thin layer over ahqp.h, with vectors and matrices of Eigen.
//
// Matrices and vectors are read in place, in any layout; errors are exceptions with the library's text. SI
// units, radians. An object is used by one thread at a time. Solver::solve and Ik::step allocate nothing,
// unless they throw.

#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "ahqp.h"

namespace ahqp {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

// A matrix that is passed. What has its numbers in memory is read in place: in either order, blocks and maps too.
// Other expressions are computed first.
class Matrix {
 public:
  template <typename Derived>
  Matrix(const Eigen::MatrixBase<Derived>& matrix) {
    if constexpr ((static_cast<int>(Derived::Flags) & static_cast<int>(Eigen::DirectAccessBit)) != 0) {
      look_at(matrix.derived());
    } else {
      computed_ = matrix;
      look_at(computed_);
    }
  }
  Matrix(const Matrix&) = delete;
  Matrix& operator=(const Matrix&) = delete;

  AhqpMatrix view() const { return view_; }

 private:
  template <typename Derived>
  void look_at(const Derived& matrix) {
    view_ = {matrix.data(), static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols()),
             static_cast<std::size_t>(matrix.rowStride()), static_cast<std::size_t>(matrix.colStride())};
  }

  AhqpMatrix view_{};
  Eigen::MatrixXd computed_;
};

// What was wrong, where, and what would be right.
class Error : public std::runtime_error {
 public:
  Error(AhqpStatus status, const std::string& text) : std::runtime_error(text), status_(status) {}
  AhqpStatus status() const { return status_; }

 private:
  AhqpStatus status_;
};

// Hard constraints contradict each other; conflict() lists rows that cannot hold together.
class InfeasibleError : public Error {
 public:
  InfeasibleError(const std::string& text, std::vector<std::string> conflict)
      : Error(AHQP_STATUS_INFEASIBLE, text), conflict_(std::move(conflict)) {}
  const std::vector<std::string>& conflict() const { return conflict_; }

 private:
  std::vector<std::string> conflict_;
};

namespace detail {

// The status, unless it is an error.
inline AhqpStatus check(AhqpStatus status) {
  if (status < 0) throw Error(status, ahqp_last_error());
  return status;
}

inline AhqpVector view(const Vector& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

inline AhqpMatrix view(const Matrix& matrix) { return matrix.view(); }

template <typename T, void (*free)(T*)>
struct Deleter {
  void operator()(T* handle) const { free(handle); }
};

template <typename T, void (*free)(T*)>
using Handle = std::unique_ptr<T, Deleter<T, free>>;

}  // namespace detail

// A hierarchical quadratic program: levels of objectives and constraints, highest priority first.
class Hierarchy {
 public:
  explicit Hierarchy(std::size_t variables) {
    AhqpHierarchy* handle = nullptr;
    detail::check(ahqp_hierarchy_new(variables, &handle));
    handle_.reset(handle);
  }

  // Bounds of the variables, ±infinity where there is none; they hold at every level.
  void set_bounds(const Vector& lower, const Vector& upper) {
    detail::check(ahqp_hierarchy_set_bounds(handle_.get(), detail::view(lower), detail::view(upper)));
  }

  // Adds a level below all present ones, lower ≤ A x ≤ upper, and returns its number. The violation of its
  // rows is minimised.
  std::size_t push(const Matrix& a, const Vector& lower, const Vector& upper, const char* name = nullptr) {
    return push(a, lower, upper, false, name);
  }

  // Adds a level of rows that must hold from it down.
  std::size_t push_hard(const Matrix& a, const Vector& lower, const Vector& upper, const char* name = nullptr) {
    return push(a, lower, upper, true, name);
  }

  // Adds a level that minimises ½ xᵀ H x + gᵀ x.
  std::size_t push_quadratic(const Matrix& h, const Vector& g, const char* name = nullptr) {
    std::size_t level = 0;
    detail::check(ahqp_hierarchy_push_quadratic(handle_.get(), detail::view(h), detail::view(g), name, &level));
    return level;
  }

  // Rewrites data of a level, in the same sizes.
  void set_matrix(std::size_t level, const Matrix& a) { update(level, detail::view(a), none(), none(), none()); }
  void set_bounds(std::size_t level, const Vector& lower, const Vector& upper) {
    update(level, no_matrix(), detail::view(lower), detail::view(upper), none());
  }
  void set_weights(std::size_t level, const Vector& weights) {
    update(level, no_matrix(), none(), none(), detail::view(weights));
  }

  // How far a level is at x from what it asks for: √(Σ wᵢ dᵢ²).
  double violation(std::size_t level, const Vector& x) const {
    double violation = 0.0;
    detail::check(ahqp_hierarchy_violation(handle_.get(), level, detail::view(x), &violation));
    return violation;
  }

  const AhqpHierarchy* get() const { return handle_.get(); }

 private:
  static AhqpVector none() { return {nullptr, 0}; }
  static AhqpMatrix no_matrix() { return {nullptr, 0, 0, 0, 0}; }

  std::size_t push(const Matrix& a, const Vector& lower, const Vector& upper, bool hard, const char* name) {
    std::size_t level = 0;
    detail::check(ahqp_hierarchy_push(handle_.get(), detail::view(a), detail::view(lower), detail::view(upper),
                                      hard, name, &level));
    return level;
  }

  void update(std::size_t level, AhqpMatrix a, AhqpVector lower, AhqpVector upper, AhqpVector weights) {
    detail::check(ahqp_hierarchy_update(handle_.get(), level, a, lower, upper, weights));
  }

  detail::Handle<AhqpHierarchy, ahqp_hierarchy_free> handle_;
};

// Solves hierarchies of one shape, each from where the one before ended.
class Solver {
 public:
  explicit Solver(const Hierarchy& hierarchy, AhqpSettings settings = ahqp_settings_default()) {
    AhqpSolver* handle = nullptr;
    detail::check(ahqp_solver_new(hierarchy.get(), &settings, &handle));
    handle_.reset(handle);
  }

  // Writes x and returns AHQP_STATUS_OK at the optimum, or …_LIMIT where the budget ran out: at most
  // `iterations` (0: as many as the settings allow) and `time` [s] (0: any).
  AhqpStatus solve(const Hierarchy& hierarchy, Eigen::Ref<Eigen::VectorXd> x, std::size_t iterations = 0,
                   double time = 0.0) {
    const AhqpStatus status = ahqp_solver_solve(handle_.get(), hierarchy.get(), iterations, time, x.data(),
                                                static_cast<std::size_t>(x.size()));
    if (status == AHQP_STATUS_INFEASIBLE) throw InfeasibleError(ahqp_last_error(), conflict(hierarchy));
    return detail::check(status);
  }

  std::size_t iterations() const { return ahqp_solver_iterations(handle_.get()); }

 private:
  std::vector<std::string> conflict(const Hierarchy& hierarchy) const {
    std::vector<std::string> rows(ahqp_solver_conflict_count(handle_.get()));
    char text[256];
    for (std::size_t row = 0; row < rows.size(); ++row) {
      if (ahqp_solver_conflict_row(handle_.get(), hierarchy.get(), row, text, sizeof text) == AHQP_STATUS_OK)
        rows[row] = text;
    }
    return rows;
  }

  detail::Handle<AhqpSolver, ahqp_solver_free> handle_;
};

// A robot by its URDF. It does not change.
class Model {
 public:
  static Model from_file(const std::string& path, AhqpBase base = AHQP_BASE_FIXED) {
    AhqpModel* handle = nullptr;
    detail::check(ahqp_model_from_file(path.c_str(), base, &handle));
    return Model(handle);
  }

  static Model from_urdf(const std::string& urdf, AhqpBase base = AHQP_BASE_FIXED) {
    AhqpModel* handle = nullptr;
    detail::check(ahqp_model_from_urdf(urdf.c_str(), base, &handle));
    return Model(handle);
  }

  std::size_t position_count() const { return ahqp_model_position_count(handle_.get()); }
  std::size_t velocity_count() const { return ahqp_model_velocity_count(handle_.get()); }

  // q with all joints at zero.
  Eigen::VectorXd neutral() const {
    Eigen::VectorXd q(position_count());
    detail::check(ahqp_model_neutral(handle_.get(), q.data(), position_count()));
    return q;
  }

  const AhqpModel* get() const { return handle_.get(); }

 private:
  explicit Model(AhqpModel* handle) : handle_(handle) {}
  detail::Handle<AhqpModel, ahqp_model_free> handle_;
};

// Differential inverse kinematics: velocities that do what levels of tasks ask, each level as well as those
// above it allow, within the limits of all joints. Tasks first, then build(), then step().
class Ik {
 public:
  explicit Ik(const Model& model) {
    AhqpIk* handle = nullptr;
    detail::check(ahqp_ik_new(model.get(), &handle));
    handle_.reset(handle);
  }

  // Tasks, each on a level below all so far; the number that is returned sets its target.
  std::size_t push_position(const char* name, const char* frame) {
    return push([&](std::size_t* task) { return ahqp_ik_push_position(handle_.get(), name, frame, task); });
  }
  std::size_t push_orientation(const char* name, const char* frame) {
    return push([&](std::size_t* task) { return ahqp_ik_push_orientation(handle_.get(), name, frame, task); });
  }
  std::size_t push_frame(const char* name, const char* frame) {
    return push([&](std::size_t* task) { return ahqp_ik_push_frame(handle_.get(), name, frame, task); });
  }
  std::size_t push_posture(const char* name) {
    return push([&](std::size_t* task) { return ahqp_ik_push_posture(handle_.get(), name, task); });
  }

  // The robot rests at q: tasks keep what they find there until they get a target.
  void build(const Vector& q) { detail::check(ahqp_ik_build(handle_.get(), detail::view(q))); }

  void set_position(std::size_t task, const Eigen::Vector3d& position,
                    const Eigen::Vector3d& velocity = Eigen::Vector3d::Zero()) {
    detail::check(ahqp_ik_set_position(handle_.get(), task, {position.data(), 3}, {velocity.data(), 3}));
  }
  void set_orientation(std::size_t task, const Eigen::Quaterniond& orientation) {
    detail::check(ahqp_ik_set_orientation(handle_.get(), task, {orientation.coeffs().data(), 4}));
  }
  void set_pose(std::size_t task, const Eigen::Vector3d& position, const Eigen::Quaterniond& orientation) {
    detail::check(ahqp_ik_set_pose(handle_.get(), task, {position.data(), 3}, {orientation.coeffs().data(), 4}));
  }
  void set_posture(std::size_t task, const Vector& q) {
    detail::check(ahqp_ik_set_posture(handle_.get(), task, detail::view(q)));
  }

  // Writes the velocities for the next `period` [s], with the robot at q.
  AhqpStatus step(const Vector& q, double period, Eigen::Ref<Eigen::VectorXd> velocity) {
    return detail::check(ahqp_ik_step(handle_.get(), detail::view(q), period, velocity.data(),
                                      static_cast<std::size_t>(velocity.size()), nullptr, 0));
  }

  // Moves q along these velocities.
  AhqpStatus integrate(Eigen::Ref<Eigen::VectorXd> q, double period) {
    const AhqpVector now{q.data(), static_cast<std::size_t>(q.size())};
    return detail::check(ahqp_ik_step(handle_.get(), now, period, nullptr, 0, q.data(), now.size));
  }

  // Velocities that stop the robot, where step() throws.
  void brake(double period, Eigen::Ref<Eigen::VectorXd> velocity) {
    detail::check(ahqp_ik_brake(handle_.get(), period, velocity.data(), static_cast<std::size_t>(velocity.size())));
  }

  // The robot moves at this velocity now.
  void reset(const Vector& velocity) { detail::check(ahqp_ik_reset(handle_.get(), detail::view(velocity))); }

  // Where a frame is in the world at q.
  std::pair<Eigen::Vector3d, Eigen::Quaterniond> pose(const Vector& q, const char* frame) {
    Eigen::Vector3d position;
    Eigen::Quaterniond orientation;
    detail::check(ahqp_ik_pose(handle_.get(), detail::view(q), frame, position.data(), orientation.coeffs().data()));
    return {position, orientation};
  }

 private:
  template <typename Push>
  std::size_t push(Push push) {
    std::size_t task = 0;
    detail::check(push(&task));
    return task;
  }

  detail::Handle<AhqpIk, ahqp_ik_free> handle_;
};

}  // namespace ahqp
