/* An importer in C, which takes nothing from an FMU on trust. What it is asked for comes on the command line. */
#include "fmu.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int count, char **arguments)
{
    const char *task = count > 1 ? arguments[1] : "";
    long numbers[3] = {0, 0, 0};
    for (int i = 0; i < 3 && i + 2 < count; i++)
        numbers[i] = atol(arguments[i + 2]);
    if (strcmp(task, "calls") == 0)
        calls();
    else if (strcmp(task, "many") == 0)
        many((size_t)numbers[0], (int)numbers[1]);
    else if (strcmp(task, "threads") == 0)
        threads((size_t)numbers[0], (size_t)numbers[1]);
    else if (strcmp(task, "unload") == 0)
        unload_beside_a_run((int)numbers[0]);
    else if (strcmp(task, "rounds") == 0)
        rounds((size_t)numbers[0], (size_t)numbers[1], numbers[2],
               count > 5 && strcmp(arguments[5], "leak") == 0);
    else if (strcmp(task, "overrun") == 0)
        overrun();
    else if (strcmp(task, "leak") == 0)
        leak();
    else {
        fprintf(stderr, "%s: calls | many INSTANCES STEPS | threads COUNT ROUNDS | unload TIMES | "
                        "rounds COUNT WARM_UP BOUND_KB [leak] | overrun | leak\n", arguments[0]);
        return 2;
    }
    return 0;
}
