// Strict priorities for robots: hierarchical quadratic programs, and inverse kinematics of any robot.
//
// Made by `cargo run --manifest-path moca-model/c/header/Cargo.toml`; do not edit. SI units, radians. A handle
// is used by one thread at a time. Functions that return a status check pointers and sizes first.

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Result of a call. If it is negative, nothing was done, and `ahqp_last_error` says why.
enum AhqpStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The call succeeded. A solve is at the optimum of every level.
  AHQP_STATUS_OK = 0,
  // The iterations ran out. Hard constraints and limits hold.
  AHQP_STATUS_ITERATION_LIMIT = 1,
  // The time ran out. Hard constraints and limits hold.
  AHQP_STATUS_TIME_LIMIT = 2,
  // A pointer is null.
  AHQP_STATUS_NULL_POINTER = -1,
  // A matrix, vector or buffer has the wrong size, or a number is not an allowed value.
  AHQP_STATUS_BAD_ARGUMENT = -2,
  // The data make no valid problem, or the robot cannot do what is asked.
  AHQP_STATUS_BAD_DATA = -3,
  // Hard constraints contradict each other.
  AHQP_STATUS_INFEASIBLE = -4,
  // The library has failed; please report this defect. The handles of the call may only be freed.
  AHQP_STATUS_PANIC = -5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum AhqpStatus AhqpStatus;
#else
typedef int32_t AhqpStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Motion of the root link in the world.
typedef enum AhqpBase {
  // No motion.
  AHQP_BASE_FIXED,
  // Motion on the plane z = 0: q begins with x, y [m] and yaw [rad].
  AHQP_BASE_PLANAR,
  // Free motion: q begins with position [m] and quaternion x, y, z, w, q̇ with a twist in the world's axes.
  AHQP_BASE_FLOATING,
} AhqpBase;

// A hierarchical quadratic program: levels of objectives and constraints, highest priority first.
typedef struct AhqpHierarchy AhqpHierarchy;

// Differential inverse kinematics of one robot. It computes velocities for levels of tasks within the limits of all
// joints. Each level is fulfilled as well as the levels above it allow. First add the tasks, then build, then step.
typedef struct AhqpIk AhqpIk;

// A robot: a tree of joints, the bodies that they move, and frames on these. It does not change.
typedef struct AhqpModel AhqpModel;

// Solver for hierarchies of one shape. Each solve starts from the result of the one before.
typedef struct AhqpSolver AhqpSolver;

// Contiguous numbers to read. A null pointer stands for an absent vector where that is allowed.
typedef struct AhqpVector {
  // Pointer to the first number.
  const double *data;
  // Number of elements.
  size_t size;
} AhqpVector;

// Matrix to read, in any layout.
typedef struct AhqpMatrix {
  // Pointer to the number in the first row and column.
  const double *data;
  // Number of rows.
  size_t rows;
  // Number of columns.
  size_t columns;
  // Distance from one row to the next, in numbers: the number of columns if rows are contiguous.
  size_t row_stride;
  // Distance from one column to the next, in numbers: 1 if rows are contiguous.
  size_t column_stride;
} AhqpMatrix;

// Settings of the solver. `ahqp_settings_default` returns the default values.
typedef struct AhqpSettings {
  // Largest number of iterations of one solve, at least 1.
  size_t max_iterations;
  // Violation below which a constraint holds, relative to its terms.
  double feasibility_tolerance;
  // Fraction of a row's norm. A row depends on others if the part that they do not span is smaller.
  double rank_tolerance;
  // Size beyond which a multiplier of the wrong sign frees its row.
  double optimality_tolerance;
  // True if a solve starts from the active set of the one before.
  bool warm_start;
} AhqpSettings;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Returns the error text of this thread's last call with a negative status: what was wrong, where, and what would
// be right. It is UTF-8, at most 1023 bytes, and valid until the next such call of this thread. It is never null.
const char *ahqp_last_error(void);

// Creates a hierarchy over `variables` variables, at most 4096, without bounds and levels.
//
// # Safety
// `out` points to room for a pointer.
AhqpStatus ahqp_hierarchy_new(size_t variables, struct AhqpHierarchy **out);

// Frees a hierarchy. A null pointer is allowed.
//
// # Safety
// `hierarchy` came from `ahqp_hierarchy_new` and is not used again.
void ahqp_hierarchy_free(struct AhqpHierarchy *hierarchy);

// Sets the bounds of the variables, one number for each, ±INFINITY where there is no bound. They hold at every level.
// A null pointer leaves the lower or the upper bounds unchanged.
//
// # Safety
// The handle is valid; the vectors point to the numbers that they describe.
AhqpStatus ahqp_hierarchy_set_bounds(struct AhqpHierarchy *hierarchy,
                                     struct AhqpVector lower,
                                     struct AhqpVector upper);

// Adds a level below all present ones: rows lower ≤ A x ≤ upper. Equal bounds make equalities; a null pointer means
// that there are no bounds.
//
// `hard` rows must hold on this level and all below. The violation of other rows is minimised. `name` is used in
// errors and may be null. The number of the level is written to `level`, which may be null.
//
// # Safety
// The handle is valid; matrix and vectors point to the numbers that they describe; the text ends with a zero byte;
// `level` points to room or is null.
AhqpStatus ahqp_hierarchy_push(struct AhqpHierarchy *hierarchy,
                               struct AhqpMatrix a,
                               struct AhqpVector lower,
                               struct AhqpVector upper,
                               bool hard,
                               const char *name,
                               size_t *level);

// Adds a level that minimises ½ xᵀ H x + gᵀ x. H is n × n, symmetric and positive semidefinite.
//
// # Safety
// See `ahqp_hierarchy_push`.
AhqpStatus ahqp_hierarchy_push_quadratic(struct AhqpHierarchy *hierarchy,
                                         struct AhqpMatrix h,
                                         struct AhqpVector g,
                                         const char *name,
                                         size_t *level);

// Replaces data of a level of rows by data of equal sizes. Null pointers leave the data unchanged. Allocates nothing,
// except for the first weights of a level.
//
// # Safety
// The handle is valid; matrix and vectors point to the numbers that they describe.
AhqpStatus ahqp_hierarchy_update(struct AhqpHierarchy *hierarchy,
                                 size_t level,
                                 struct AhqpMatrix a,
                                 struct AhqpVector lower,
                                 struct AhqpVector upper,
                                 struct AhqpVector weights);

// Computes the violation √(Σ wᵢ dᵢ²) of a level at x, where dᵢ is the distance of row i to its range. It is zero for
// levels without rows to minimise.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes; `violation` points to room for a number.
AhqpStatus ahqp_hierarchy_violation(const struct AhqpHierarchy *hierarchy,
                                    size_t level,
                                    struct AhqpVector x,
                                    double *violation);

// Returns the default settings.
struct AhqpSettings ahqp_settings_default(void);

// Creates a solver for hierarchies with the shape of this one. Null settings are the default ones.
//
// # Safety
// The hierarchy is valid; `settings` points to settings or is null; `out` points to room for a pointer.
AhqpStatus ahqp_solver_new(const struct AhqpHierarchy *hierarchy,
                           const struct AhqpSettings *settings,
                           struct AhqpSolver **out);

// Frees a solver. A null pointer is allowed.
//
// # Safety
// `solver` came from `ahqp_solver_new` and is not used again.
void ahqp_solver_free(struct AhqpSolver *solver);

// Solves a hierarchy of the shape that the solver was made for, and writes x. `iterations` limits the iterations (0:
// the limit of the settings) and `time` the time [s] (0: no limit). Allocates nothing, unless it returns an error.
//
// Returns `AHQP_STATUS_OK` at the optimum, or `…_LIMIT` with the best x so far.
//
// # Safety
// The handles are valid; `x` points to `size` numbers.
AhqpStatus ahqp_solver_solve(struct AhqpSolver *solver,
                             const struct AhqpHierarchy *hierarchy,
                             size_t iterations,
                             double time,
                             double *x,
                             size_t size);

// Returns the number of iterations of the last solve; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_solver_iterations(const struct AhqpSolver *solver);

// Returns the number of rows that cannot hold together, after a solve that returned `AHQP_STATUS_INFEASIBLE`; else 0.
//
// # Safety
// The handle is valid or null.
size_t ahqp_solver_conflict_count(const struct AhqpSolver *solver);

// Describes one of these rows in words: UTF-8 with a zero byte at its end, cut if it does not fit.
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
// See `ahqp_model_from_urdf`.
AhqpStatus ahqp_model_from_file(const char *path, int32_t base, struct AhqpModel **out);

// Frees a robot. A null pointer is allowed. Objects that were made from the robot stay valid.
//
// # Safety
// `model` came from this library and is not used again.
void ahqp_model_free(struct AhqpModel *model);

// Returns the size of q; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_model_position_count(const struct AhqpModel *model);

// Returns the size of q̇, the number of degrees of freedom; 0 for null.
//
// # Safety
// The handle is valid or null.
size_t ahqp_model_velocity_count(const struct AhqpModel *model);

// Writes q with all joints at zero.
//
// # Safety
// The handle is valid; `q` points to `size` numbers.
AhqpStatus ahqp_model_neutral(const struct AhqpModel *model, double *q, size_t size);

// Creates an inverse kinematics without tasks.
//
// # Safety
// The model is valid; `out` points to room for a pointer.
AhqpStatus ahqp_ik_new(const struct AhqpModel *model, struct AhqpIk **out);

// Frees an inverse kinematics. A null pointer is allowed.
//
// # Safety
// `ik` came from `ahqp_ik_new` and is not used again.
void ahqp_ik_free(struct AhqpIk *ik);

// Adds a task that brings the origin of a frame to a point, on a level below all present ones. The number of the task
// is written to `task`, which may be null.
//
// # Safety
// The handle is valid; the texts end with a zero byte; `task` points to room or is null.
AhqpStatus ahqp_ik_push_position(struct AhqpIk *ik,
                                 const char *name,
                                 const char *frame,
                                 size_t *task);

// Adds a task that turns a frame to an orientation.
//
// # Safety
// See `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_orientation(struct AhqpIk *ik, const char *name, const char *frame, size_t *task);

// Adds a task that brings a frame to a pose.
//
// # Safety
// See `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_frame(struct AhqpIk *ik, const char *name, const char *frame, size_t *task);

// Adds a task that brings all joints to a configuration. As the last task it decides the motions that no other task
// decides.
//
// # Safety
// See `ahqp_ik_push_position`.
AhqpStatus ahqp_ik_push_posture(struct AhqpIk *ik,
                                const char *name,
                                size_t *task);

// Builds the problem of all tasks, with the robot at rest at q. Tasks without a target hold the state at q.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes.
AhqpStatus ahqp_ik_build(struct AhqpIk *ik, struct AhqpVector q);

// Sets the target of a position task: a point of the world [m] and its velocity [m/s], three numbers each. A null
// velocity means a point at rest.
//
// # Safety
// The handle is valid; the vectors point to the numbers that they describe.
AhqpStatus ahqp_ik_set_position(struct AhqpIk *ik,
                                size_t task,
                                struct AhqpVector position,
                                struct AhqpVector velocity);

// Sets the target of an orientation task: a unit quaternion x, y, z, w.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes.
AhqpStatus ahqp_ik_set_orientation(struct AhqpIk *ik, size_t task, struct AhqpVector quaternion);

// Sets the target of a frame task: a point of the world [m] and a unit quaternion x, y, z, w.
//
// # Safety
// The handle is valid; the vectors point to the numbers that they describe.
AhqpStatus ahqp_ik_set_pose(struct AhqpIk *ik,
                            size_t task,
                            struct AhqpVector position,
                            struct AhqpVector quaternion);

// Sets the target of a posture task, a complete q.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes.
AhqpStatus ahqp_ik_set_posture(struct AhqpIk *ik, size_t task, struct AhqpVector q);

// Computes the velocities for the next `period` [s], from q and the velocity of the last step. Writes q̇, and q
// after the period; either pointer may be null. `next_q` may point to the numbers of q. Allocates nothing, unless it
// returns an error.
//
// Returns `AHQP_STATUS_OK`, or `…_LIMIT` if the solver's iterations ran out; the limits hold in this case too. After
// an error, `ahqp_ik_brake` gives velocities that stop the robot.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes; the pointers, if not null, point to room.
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

// Sets the robot's current velocity, without acceleration.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes.
AhqpStatus ahqp_ik_reset(struct AhqpIk *ik, struct AhqpVector velocity);

// Writes the pose of a frame in the world at q: its position [m], three numbers, and its orientation, a unit
// quaternion x, y, z, w. Either pointer may be null.
//
// # Safety
// The handle is valid; the vector points to the numbers that it describes; the text ends with a zero byte; the
// pointers, if not null, point to room.
AhqpStatus ahqp_ik_pose(struct AhqpIk *ik,
                        struct AhqpVector q,
                        const char *frame,
                        double *position,
                        double *quaternion);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus
