/* Load, instantiate, initialize, step, free, unload, again and again: what stays behind? */
#include "fmu.h"
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* States, which take as long as all the rest, come in every fourth round. */
enum { STEPS = 2, SELDOM = 4 };

struct memory {
    long resident_kb;
    long heap; /* bytes that are allocated */
};

static struct memory look(void)
{
    long size = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    CHECK(file && fscanf(file, "%ld %ld", &size, &resident) == 2, "no /proc/self/statm");
    fclose(file);
    const struct mallinfo2 info = mallinfo2();
    return (struct memory){resident * (sysconf(_SC_PAGESIZE) / 1024), (long)(info.uordblks + info.hblkhd)};
}

/* What a host may do besides; and what goes wrong must not stay behind either. */
static void states_and_refusals(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    CHECK(!instantiate(fmu, log->name, "{no such GUID}", NULL, log) && log->errors == 1, "another's GUID");
    fmi2FMUstate state = NULL, read = NULL;
    size_t size = 0;
    CHECK(fmu->fmi2GetFMUstate(c, &state) == fmi2OK, "save");
    CHECK(fmu->fmi2GetFMUstate(c, &state) == fmi2OK, "save again");
    CHECK(fmu->fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK, "size");
    fmi2Byte *bytes = malloc(size);
    CHECK(bytes && fmu->fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK, "to bytes");
    CHECK(fmu->fmi2DeSerializeFMUstate(c, bytes, size, &read) == fmi2OK, "from bytes");
    fmi2FMUstate none = NULL;
    CHECK(fmu->fmi2DeSerializeFMUstate(c, bytes, size - 1, &none) == fmi2Error && log->errors == 2, "cut bytes");
    free(bytes);
    CHECK(fmu->fmi2SetFMUstate(c, read) == fmi2OK, "back");
    CHECK(fmu->fmi2FreeFMUstate(c, &state) == fmi2OK && fmu->fmi2FreeFMUstate(c, &read) == fmi2OK, "free states");
}

static void round_of(const struct about *about, size_t number, struct outputs *found)
{
    struct fmu fmu;
    load(&fmu, about);
    struct log log = {"round", 0, 0};
    fmi2Component c = start(&fmu, &log, push(0));
    for (int i = 0; i < STEPS; i++)
        step(&fmu, c, push(0), i);
    if (number % SELDOM == 0)
        states_and_refusals(&fmu, c, &log);
    read_outputs(&fmu, c, found);
    fmu.fmi2FreeInstance(c);
    unload(&fmu);
}

void rounds(size_t count, size_t warm_up, long bound_kb, int leak)
{
    struct outputs expected, found;
    struct fmu fmu;
    load(&fmu, &STICK_SLIP);
    alone(&fmu, push(0), STEPS, &expected);
    unload(&fmu);
    const double began = seconds();
    struct memory before = look();
    for (size_t i = 0; i < warm_up + count; i++) {
        if (i == warm_up)
            before = look();
        round_of(&STICK_SLIP, i, &found);
        CHECK(memcmp(&expected, &found, sizeof found) == 0, "round %zu ends otherwise", i);
        if (leak) {
            void *volatile lost = malloc(16);
            (void)lost;
        }
    }
    const struct memory after = look();
    const long heap_kb = (after.heap - before.heap) / 1024, resident_kb = after.resident_kb - before.resident_kb;
    printf("%zu rounds of load, instantiate, initialize, step, free, unload after %zu others; %.1f s\n"
           "  allocated %ld bytes before, %ld after; resident %ld kB before, %ld kB after\n",
           count, warm_up, seconds() - began, before.heap, after.heap, before.resident_kb, after.resident_kb);
    fflush(stdout);
    if (bound_kb == 0)
        return; /* somebody else watches */
    CHECK(heap_kb <= bound_kb, "what is allocated grew by %ld kB", heap_kb);
    /* Pages of the C library and the loader come to that. */
    CHECK(resident_kb <= bound_kb + 512, "resident memory grew by %ld kB", resident_kb);
}
