/* Many instances of two FMUs, alive at once and stepped in turn. */
#include "fmu.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void many(size_t instances, int steps)
{
    const double began = seconds();
    struct fmu fmus[2];
    load(&fmus[0], &SET1);
    load(&fmus[1], &RING12);
    struct outputs (*expected)[PUSHES] = calloc(2, sizeof *expected), found;
    fmi2Component *alive = calloc(instances, sizeof *alive);
    CHECK(expected && alive, "no memory");
    for (size_t f = 0; f < 2; f++)
        for (size_t p = 0; p < PUSHES; p++) {
            alone(&fmus[f], push(p), steps, &expected[f][p]);
            CHECK(p == 0 || memcmp(expected[f][p].real, expected[f][p - 1].real, sizeof expected[f][p].real) != 0,
                  "two pushes lead to the same");
        }

    /* Instance i is one of the FMU i % 2, with push i / 2. */
    for (size_t i = 0; i < instances; i++)
        alive[i] = start(&fmus[i % 2], NULL, push(i / 2));
    for (int number = 0; number < steps; number++) {
        for (size_t i = 0; i < instances; i++)
            drive(&fmus[i % 2], alive[i], push(i / 2), number);
        for (size_t i = 0; i < instances; i++)
            advance(&fmus[i % 2], alive[i], number);
    }
    for (size_t i = 0; i < instances; i++) {
        read_outputs(&fmus[i % 2], alive[i], &found);
        same(&fmus[i % 2], &expected[i % 2][(i / 2) % PUSHES], &found, "one of many");
    }

    /* Freed in another order: 7 has no factor in common with a count that ends in zeros. What is left goes on. */
    CHECK(instances % 7 != 0, "%zu", instances);
    for (size_t k = 0; k < instances; k++) {
        size_t i = 7 * k % instances, next = 7 * (k + 1) % instances;
        fmus[i % 2].fmi2FreeInstance(alive[i]);
        if (k + 1 < instances) {
            read_outputs(&fmus[next % 2], alive[next], &found);
            same(&fmus[next % 2], &expected[next % 2][(next / 2) % PUSHES], &found, "one of those that are left");
        }
    }
    unload(&fmus[0]);
    unload(&fmus[1]);
    free(expected);
    free(alive);
    printf("%zu instances at once, %d communication steps each: the same bits as alone; %.1f s\n", instances, steps,
           seconds() - began);
}
