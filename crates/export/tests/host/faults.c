/* Misuse on purpose: whoever watches this program has to see it. */
#include "fmu.h"
#include <stdio.h>
#include <stdlib.h>

void overrun(void)
{
    struct fmu fmu;
    load(&fmu, &SET1);
    fmi2Component c = start(&fmu, NULL, push(0));
    const size_t count = fmu.about->outputs;
    fmi2Real *values = malloc((count - 1) * sizeof *values);
    CHECK(values, "no memory");
    CHECK(fmu.fmi2GetReal(c, fmu.about->output, count, values) == fmi2OK, "the library cannot know");
    printf("%g\n", values[0]);
    free(values);
    fmu.fmi2FreeInstance(c);
    unload(&fmu);
}

/* In a frame of its own, which no pointer outlives. */
__attribute__((noinline)) static void lose(const struct fmu *fmu)
{
    start(fmu, NULL, push(0));
}

void leak(void)
{
    struct fmu fmu;
    load(&fmu, &SET1);
    /* One may still be found in a register or in what is left on the stack; not all. */
    for (int i = 0; i < 5; i++)
        lose(&fmu);
}
