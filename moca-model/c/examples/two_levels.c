/* First x + y = 2, then x as near to 5 as its bounds and the first level allow, in plain C. */
#include <ahqp.h>
#include <math.h>
#include <stdio.h>

static int failed(AhqpStatus status) {
    if (status < 0) fprintf(stderr, "%s\n", ahqp_last_error());
    return status != AHQP_STATUS_OK;
}

int main(void) {
    const double lower[] = {-1.0, -1.0}, upper[] = {1.5, 9.0}, sum[] = {1.0, 1.0}, near[] = {1.0, 0.0};
    const double two = 2.0, five = 5.0;
    double x[2];
    AhqpHierarchy *hierarchy = NULL;
    AhqpSolver *solver = NULL;
    int is_wrong =
        failed(ahqp_hierarchy_new(2, &hierarchy)) ||
        failed(ahqp_hierarchy_set_bounds(hierarchy, (AhqpVector){lower, 2}, (AhqpVector){upper, 2})) ||
        failed(ahqp_hierarchy_push(hierarchy, (AhqpMatrix){sum, 1, 2, 2, 1}, (AhqpVector){&two, 1},
                                   (AhqpVector){&two, 1}, false, "sum", NULL)) ||
        failed(ahqp_hierarchy_push(hierarchy, (AhqpMatrix){near, 1, 2, 2, 1}, (AhqpVector){&five, 1},
                                   (AhqpVector){&five, 1}, false, "near", NULL)) ||
        failed(ahqp_solver_new(hierarchy, NULL, &solver)) ||
        failed(ahqp_solver_solve(solver, hierarchy, 0, 0.0, x, 2));
    if (!is_wrong) printf("%.12g %.12g\n", x[0], x[1]);
    ahqp_solver_free(solver);
    ahqp_hierarchy_free(hierarchy);
    return is_wrong;
}
