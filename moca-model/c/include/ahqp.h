// Strict priorities for robots: hierarchical quadratic programmes, and inverse kinematics of any robot.
//
// Made by `cargo run --manifest-path moca-model/c/header/Cargo.toml`; do not edit. SI units, radians. A handle
// is used by one thread at a time. Functions that return a status check pointers and sizes first.

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// How a call ended. Negative: nothing was done, and `ahqp_last_error` says why.
enum AhqpStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // All is done; of a solve: every level is at its optimum.
  AHQP_STATUS_OK = 0,
  // The iterations ran out. Hard constraints and limits hold.
  AHQP_STATUS_ITERATION_LIMIT = 1,
  // The time ran out. Hard constraints and limits hold.
  AHQP_STATUS_TIME_LIMIT = 2,
  // A pointer is null.
  AHQP_STATUS_NULL_POINTER = -1,
  // A matrix, vector or buffer has another size than is needed, or a number is none of those that are meant.
  AHQP_STATUS_BAD_ARGUMENT = -2,
  // The data make no problem, or a robot cannot do what it is asked.
  AHQP_STATUS_BAD_DATA = -3,
  // Hard constraints contradict each other.
  AHQP_STATUS_INFEASIBLE = -4,
  // The library has failed: a defect, to be reported. Free the handles of the call, and no more.
  AHQP_STATUS_PANIC = -5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AhqpStatus AhqpStatus;
#else
typedef int32_t AhqpStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How the root link moves in the world.
typedef enum AhqpBase {
  // Not at all.
  AHQP_BASE_FIXED,
  // On the plane z = 0: q begins with x, y [m] and yaw [rad].
  AHQP_BASE_PLANAR,
  // Freely: q begins with position [m] and quaternion x, y, z, w, q̇ with a twist in the world's axes.
  AHQP_BASE_FLOATING,
} AhqpBase;

// A hierarchical quadratic programme: levels of objectives and constraints, highest priority first.
typedef struct AhqpHierarchy AhqpHierarchy;

// Differential inverse kinematics of one robot: velocities that do what levels of tasks ask, each level as
// well as those above it allow, within the limits of all joints. First tasks are added, then it is
// built, then it steps.
typedef struct AhqpIk AhqpIk;

// A robot: a tree of joints, the bodies that they move, and frames on these. It does not change.
typedef struct AhqpModel AhqpModel;

// Solves hierarchies of one shape, each from where the one before ended.
typedef struct AhqpSolver AhqpSolver;

// Numbers one after another, to be read. A null pointer stands for none at all where that is allowed.
typedef struct AhqpVector {
  // The first number.
  const double *data;
  // How many there are.
  size_t size;
} AhqpVector;

// A matrix to be read, in any layout.
typedef struct AhqpMatrix {
  // The number in the first row and column.
  const double *data;
  // How many rows it has.
  size_t rows;
  // How many columns it has.
  size_t columns;
  // How many numbers a row is from the next one: the count of columns, where rows follow each other.
  size_t row_stride;
  // How many numbers a column is from the next one: 1, where rows follow each other.
  size_t column_stride;
} AhqpMatrix;

// The solver's few parameters; `ahqp_settings_default` fills them in.
typedef struct AhqpSettings {
  // Iterations of one solve, at least 1.
  size_t max_iterations;
  // A constraint holds when it is violated by less than this, relative to its terms.
  double feasibility_tolerance;
  // A row depends on others when what they leave of it is below this fraction of its norm.
  double rank_tolerance;
  // A multiplier of the wrong sign frees its row beyond this.
  double optimality_tolerance;
  // Whether a solve starts from the active set of the one before.
  bool warm_start;
} AhqpSettings;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// What was wrong with the last call of this thread that returned a negative status, where, and what would
// be right: UTF-8, at most 1023 bytes, valid until the next such call of this thread. Never null.
const char *ahqp_last_error(void);

// Makes a hierarchy over so many variables, at most 4096, without bounds and levels.
//
// # Safety
// `out` points to room for a pointer.
AhqpStatus ahqp_hierarchy_new(size_t variables, struct AhqpHierarchy **out);

// Frees a hierarchy. Null is none.
//
// # Safety
// `hierarchy` came from `ahqp_hierarchy_new` and is not used again.
void ahqp_hierarchy_free(struct AhqpHierarchy *hierarchy);

// Sets the bounds of the variables, one number each, ±INFINITY where there is none. They hold at every
// level. A null pointer leaves a side as it is.
//
// # Safety
// The handle is valid; the vectors are what they say.
AhqpStatus ahqp_hierarchy_set_bounds(struct AhqpHierarchy *hierarchy,
                                     struct AhqpVector lower,
                                     struct AhqpVector upper);

// Adds a level below all present ones: rows lower ≤ A x ≤ upper. Equal bounds make equalities; a null
// pointer stands for no bounds. `hard` rows must hold from this level down, else their violation is
// minimised. `name`, null for none, is for errors. `level`, null if it does not matter, is where to put
// the number of the level.
//
// # Safety
// The handle is valid; matrix, vectors and text are what they say; `level` points to room or is null.
AhqpStatus ahqp_hierarchy_push(struct AhqpHierarchy *hierarchy,
                               struct AhqpMatrix a,
                               struct AhqpVector lower,
                               struct AhqpVector upper,
                               bool hard,
                               const char *name,
                               size_t *level);

// Adds a level that minimises ½ xᵀ H x + gᵀ x, H being n × n, symmetric and positive semidefinite.
//
// # Safety
// As of `ahqp_hierarchy_push`.
AhqpStatus ahqp_hierarchy_push_quadratic(struct AhqpHierarchy *hierarchy,
                                         struct AhqpMatrix h,
                                         struct AhqpVector g,
                                         const char *name,
                                         size_t *level);

// Rewrites data of a level of rows, in the same sizes; what is null stays. Allocates nothing, but the
// first weights of a level do.
//
// # Safety
// The handle is valid; matrix and vectors are what they say.
AhqpStatus ahqp_hierarchy_update(struct AhqpHierarchy *hierarchy,
                                 size_t level,
                                 struct AhqpMatrix a,
                                 struct AhqpVector lower,
                                 struct AhqpVector upper,
                                 struct AhqpVector weights);

// √(Σ wᵢ dᵢ²) of a level at x, dᵢ being the distance of row i to its range; zero for levels without rows
// to minimise.
//
// # Safety
// The handle is valid; the vector is what it says; `violation` points to room for a number.
AhqpStatus ahqp_hierarchy_violation(const struct AhqpHierarchy *hierarchy,
                                    size_t level,
                                    struct AhqpVector x,
                                    double *violation);

// The settings that a solver has without being told.
struct AhqpSettings ahqp_settings_default(void);

// Makes a solver for hierarchies of this one's shape, with settings, or null for the default ones.
//
// # Safety
// The hierarchy is valid; `settings` points to settings or is null; `out` points to room for a pointer.
AhqpStatus ahqp_solver_new(const struct AhqpHierarchy *hierarchy,
                           const struct AhqpSettings *settings,
                           struct AhqpSolver **out);

// Frees a solver. Null is none.
//
// # Safety
// `solver` came from `ahqp_solver_new` and is not used again.
void ahqp_solver_free(struct AhqpSolver *solver);

// Solves a hierarchy of the shape that the solver was made for, in at most `iterations` (0: as many as the
// settings allow) and `time` [s] (0: any), and writes x. Allocates nothing, unless it returns an error.
//
// Returns `AHQP_STATUS_OK` at the optimum, or `…_LIMIT` with x as far as it came.
//
// # Safety
// The handles are valid; `x` points to `size` numbers.
AhqpStatus ahqp_solver_solve(struct AhqpSolver *solver,
                             const struct AhqpHierarchy *hierarchy,
                             size_t iterations,
                             double time,
                             double *x,
                             size_t size);

// Iterations of the last solve; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_solver_iterations(const struct AhqpSolver *solver);

// How many rows cannot hold together, after a solve that returned `AHQP_STATUS_INFEASIBLE`; else 0.
//
// # Safety
// The handle is valid or null.
size_t ahqp_solver_conflict_count(const struct AhqpSolver *solver);

// One of these rows in words, UTF-8 with a zero byte at its end, cut where there is no more room.
//
// # Safety
// The handles are valid; `text` points to `size` bytes.
AhqpStatus ahqp_solver_conflict_row(const struct AhqpSolver *solver,
                                    const struct AhqpHierarchy *hierarchy,
                                    size_t index,
                                    char *text,
                                    size_t size);

// Reads a robot from the text of a URDF. `base` is a value of `AhqpBase`.
//
// # Safety
// The text ends with a zero byte; `out` points to room for a pointer.
AhqpStatus ahqp_model_from_urdf(const char *urdf, int32_t base, struct AhqpModel **out);

// Reads a robot from a URDF file.
//
// # Safety
// As of `ahqp_model_from_urdf`.
AhqpStatus ahqp_model_from_file(const char *path, int32_t base, struct AhqpModel **out);

// Frees a robot. Null is none. What was made of it stays.
//
// # Safety
// `model` came from this library and is not used again.
void ahqp_model_free(struct AhqpModel *model);

// The size of q; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_model_position_count(const struct AhqpModel *model);

// The size of q̇, the number of degrees of freedom; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_model_velocity_count(const struct AhqpModel *model);

// Writes q with all joints at zero.
//
// # Safety
// The handle is valid; `q` points to `size` numbers.
AhqpStatus ahqp_model_neutral(const struct AhqpModel *model, double *q, size_t size);

// Makes an inverse kinematics without tasks.
//
// # Safety
// The model is valid; `out` points to room for a pointer.
AhqpStatus ahqp_ik_new(const struct AhqpModel *model, struct AhqpIk **out);

// Frees an inverse kinematics. Null is none.
//
// # Safety
// `ik` came from `ahqp_ik_new` and is not used again.
void ahqp_ik_free(struct AhqpIk *ik);

// Adds a task that brings the origin of a frame to a point, on a level below all so far. `task`, null if
// it does not matter, is where to put its number.
//
// # Safety
// The handle is valid; the texts end with a zero byte; `task` points to room or is null.
AhqpStatus ahqp_ik_push_position(struct AhqpIk *ik, const char *name, const char *frame, size_t *task);

// Adds a task that turns a frame into an orientation.
//
// # Safety
// As of `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_orientation(struct AhqpIk *ik, const char *name, const char *frame, size_t *task);

// Adds a task that brings a frame to a pose.
//
// # Safety
// As of `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_frame(struct AhqpIk *ik, const char *name, const char *frame, size_t *task);

// Adds a task that brings all joints to a configuration. As the last task it decides what no other does.
//
// # Safety
// As of `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_posture(struct AhqpIk *ik, const char *name, size_t *task);

// Builds what the tasks ask for, with the robot at rest at q: tasks keep what they find there until they
// get a target.
//
// # Safety
// The handle is valid; the vector is what it says.
AhqpStatus ahqp_ik_build(struct AhqpIk *ik, struct AhqpVector q);

// Sets the target of a position task: a point of the world [m], three numbers, and how fast it moves
// [m/s], null for a point that rests.
//
// # Safety
// The handle is valid; the vectors are what they say.
AhqpStatus ahqp_ik_set_position(struct AhqpIk *ik,
                                size_t task,
                                struct AhqpVector position,
                                struct AhqpVector velocity);

// Sets the target of an orientation task: a unit quaternion x, y, z, w.
//
// # Safety
// The handle is valid; the vector is what it says.
AhqpStatus ahqp_ik_set_orientation(struct AhqpIk *ik, size_t task, struct AhqpVector quaternion);

// Sets the target of a frame task: a point of the world [m] and a unit quaternion x, y, z, w.
//
// # Safety
// The handle is valid; the vectors are what they say.
AhqpStatus ahqp_ik_set_pose(struct AhqpIk *ik,
                            size_t task,
                            struct AhqpVector position,
                            struct AhqpVector quaternion);

// Sets the target of a posture task, a whole q.
//
// # Safety
// The handle is valid; the vector is what it says.
AhqpStatus ahqp_ik_set_posture(struct AhqpIk *ik, size_t task, struct AhqpVector q);

// The velocities for the next `period` [s], with the robot at q and the velocity of the last step. Writes
// q̇ and q after the period; null for what is not wanted. `next_q` may be the same numbers as q. Allocates
// nothing, unless it returns an error.
//
// Returns `AHQP_STATUS_OK`, or `…_LIMIT` where the solver's iterations ran out: limits hold then, too. With
// an error `ahqp_ik_brake` gives velocities that stop the robot.
//
// # Safety
// The handle is valid; the vector is what it says; the pointers, if not null, point to room.
AhqpStatus ahqp_ik_step(struct AhqpIk *ik,
                        struct AhqpVector q,
                        double period,
                        double *velocity,
                        size_t velocity_size,
                        double *next_q,
                        size_t next_q_size);

// Brakes every joint for a period [s], at the limits of acceleration and jerk, and writes q̇.
//
// # Safety
// The handle is valid; `velocity` points to `size` numbers.
AhqpStatus ahqp_ik_brake(struct AhqpIk *ik, double period, double *velocity, size_t size);

// Says that the robot moves at this velocity now, not accelerating.
//
// # Safety
// The handle is valid; the vector is what it says.
AhqpStatus ahqp_ik_reset(struct AhqpIk *ik, struct AhqpVector velocity);

// Writes where a frame is in the world at q: its position [m], three numbers, and its orientation, a unit
// quaternion x, y, z, w; null for what is not wanted.
//
// # Safety
// The handle is valid; vector and text are what they say; the pointers, if not null, point to room.
AhqpStatus ahqp_ik_pose(struct AhqpIk *ik,
                        struct AhqpVector q,
                        const char *frame,
                        double *position,
                        double *quaternion);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus
