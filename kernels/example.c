/* A cyclic test of a small rubber bearing: displacement, force and temperature of every step.
   cc example.c linux-x86_64-v1.so -lm && ./a.out > loops.txt; kN, mm, s, degC */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include "thermobearing.h"

enum { STEPS = 400, CYCLE = 100 };
#define ONE(array) {&(array), {1}}       /* an array of one number or row */
#define NONE {0, {0}}                    /* an empty one */
#define ROOM(array) {(array), {STEPS}}   /* one entry for each step */

int main(void)
{
    /* One rubber layer and one heat cell. */
    double multiplicity = 1.0, none = 0.0, end_loss = 1e-4, capacity = 2000.0;
    tb_LayerCells place = {.first = 0, .last = 1, .upper_middle = 0, .lower_middle = 0};
    tb_Constants constants = {
        .rubber = {.layer_count = 1.0, .layer_share = 1.0,
                   .elastic_stiffness = 1.0, .hysteretic_stiffness = 8.0,
                   .elastic_exponent = -0.004, .hysteretic_exponent = -0.012,
                   .reference_temperature = 23.0, .monotone = 1,
                   .yield_displacement = 4.0, .per_yield_displacement = 1.0 / 4.0,
                   .unloading_curvature = 0.05, .scragging_displacement = 1.0,
                   .mullins_decay = 1.0, .mullins_renewal = 1.0, .sharing_full = -1.0},
        .lead = {.clock_rate = 1.0, .fold = 1.0},
        .viscous = {.relaxation = 1.0},
        .law = NONE, .multiplicity = ONE(multiplicity), .layer_cells = ONE(place),
        .cells = {ONE(none), ONE(none), ONE(end_loss), ONE(none), ONE(capacity), ONE(none)},
        .lead_cells = NONE, .lead_modes = NONE, .source_rise = 1.0 / 2000.0,
        .side_implicit = 1, .limits = {-273.15, 1e9, 1e9},
    };
    double scratch[12] = {0};
    tb_DurationWork duration = {0};
    tb_Workspace work = {
        .duration = ONE(duration),
        .layers = {ONE(scratch[0]), ONE(scratch[1]), ONE(scratch[2]), ONE(scratch[3]),
                   ONE(scratch[4]), ONE(scratch[5]), ONE(scratch[6]), ONE(scratch[7])},
        .cells = {ONE(scratch[8]), ONE(scratch[9]), ONE(scratch[10]), ONE(scratch[11])},
        .lead_ports = {{0, {0, 0}}, NONE, NONE}, .lead_modes = NONE,
    };
    tb_Layer layers[2] = {{.virgin = 1.0}, {.virgin = 1.0}};
    tb_Branches branches[2] = {{.idle = 1e30}, {.idle = 1e30}};
    tb_BearingResponse response[2] = {{0}}, kept[STEPS];
    double temperature[2] = {-20.0, -20.0}, x[STEPS], dt[STEPS], air[STEPS], warm[STEPS];
    bool keep[STEPS];
    tb_State state[2];
    for (int k = 0; k < 2; k++) {
        tb_State one = {ONE(layers[k]), {0, {1, 0}}, ONE(temperature[k]), ONE(branches[k]),
                        NONE, ONE(response[k])};
        state[k] = one;
    }
    for (int k = 0; k < STEPS; k++) {
        x[k] = 30.0 * sin(2.0 * 3.14159265358979323846 * (k + 1) / CYCLE);
        dt[k] = 0.02, air[k] = -20.0, keep[k] = true;
    }
    tb_Path path = {ROOM(x), ROOM(dt), ROOM(air), ROOM(keep), 0.0};
    tb_Kept rows = {ROOM(kept), {warm, {STEPS, 1}}, {0, {STEPS, 0}}, {0, {STEPS, 0}},
                    {0, {STEPS, 0}}};
    tb_march_call test = {&constants, &work, &state[0], &state[1], &path, &rows, 0, 0, 0, 0, 0};
    thermobearing_march(&test);
    for (int k = 0; k < test.result1; k++)
        printf("%.17g %.17g %.17g\n", kept[k].displacement, kept[k].force, warm[k]);
    return test.result2; /* 0: completed */
}
