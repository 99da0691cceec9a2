/* Threads with instances of their own, and a library that goes while another is in use. */
#include "fmu.h"
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

enum { STEPS = 20, HALF = STEPS / 2 };

/* What all threads read and none writes. */
struct work {
    const struct fmu *fmus; /* two */
    struct outputs (*expected)[PUSHES];
    size_t rounds;
    pthread_barrier_t start;
};

struct worker {
    pthread_t thread;
    size_t number;
    struct work *work;
};

/* All that is done with one instance; its outputs must be those. */
static void life(const struct fmu *fmu, fmi2Real push, const struct outputs *expected)
{
    struct outputs found;
    struct log log = {"in a thread", 0, 0};
    fmi2Component c = start(fmu, &log, push);
    for (int number = 0; number < HALF; number++)
        step(fmu, c, push, number);
    fmi2FMUstate state = NULL, read = NULL;
    size_t size = 0;
    CHECK(fmu->fmi2GetFMUstate(c, &state) == fmi2OK, "save");
    CHECK(fmu->fmi2SerializedFMUstateSize(c, state, &size) == fmi2OK, "size");
    fmi2Byte *bytes = malloc(size);
    CHECK(bytes, "no memory");
    CHECK(fmu->fmi2SerializeFMUstate(c, state, bytes, size) == fmi2OK, "to bytes");
    CHECK(fmu->fmi2DeSerializeFMUstate(c, bytes, size, &read) == fmi2OK, "from bytes");
    free(bytes);
    const fmi2FMUstate states[] = {state, read};
    for (size_t i = 0; i < 3; i++) {
        for (int number = HALF; number < STEPS; number++)
            step(fmu, c, push, number);
        read_outputs(fmu, c, &found);
        same(fmu, expected, &found, "in a thread");
        if (i < 2)
            CHECK(fmu->fmi2SetFMUstate(c, states[i]) == fmi2OK, "back");
    }
    CHECK(fmu->fmi2FreeFMUstate(c, &state) == fmi2OK, "free a state");
    CHECK(fmu->fmi2FreeFMUstate(c, &read) == fmi2OK, "free a state");
    /* An error has a message; it is this thread's. */
    CHECK(fmu->fmi2GetReal(c, NULL, 1, NULL) == fmi2Error && log.errors == 1, "%zu errors", log.errors);
    fmu->fmi2FreeInstance(c);
}

static void *live(void *argument)
{
    struct worker *worker = argument;
    struct work *work = worker->work;
    pthread_barrier_wait(&work->start);
    for (size_t round = 0; round < work->rounds; round++) {
        const size_t f = (worker->number + round) % 2, p = (worker->number / 2 + round) % PUSHES;
        life(&work->fmus[f], push(p), &work->expected[f][p]);
    }
    return NULL;
}

void threads(size_t count, size_t rounds)
{
    const double began = seconds();
    struct fmu fmus[2];
    load(&fmus[0], &SET1);
    load(&fmus[1], &RING12);
    struct outputs (*expected)[PUSHES] = calloc(2, sizeof *expected);
    struct worker *workers = calloc(count, sizeof *workers);
    CHECK(expected && workers, "no memory");
    for (size_t f = 0; f < 2; f++)
        for (size_t p = 0; p < PUSHES; p++)
            alone(&fmus[f], push(p), STEPS, &expected[f][p]);
    /* Once before all threads: the first checksum finds out what the processor can do, and keeps it in an atomic
       number, which helgrind does not know from any other. */
    life(&fmus[0], push(0), &expected[0][0]);
    life(&fmus[1], push(0), &expected[1][0]);
    struct work work = {.fmus = fmus, .expected = expected, .rounds = rounds};
    CHECK(pthread_barrier_init(&work.start, NULL, (unsigned)count) == 0, "a barrier");
    for (size_t i = 0; i < count; i++) {
        workers[i].number = i;
        workers[i].work = &work;
        CHECK(pthread_create(&workers[i].thread, NULL, live, &workers[i]) == 0, "thread %zu", i);
    }
    for (size_t i = 0; i < count; i++)
        CHECK(pthread_join(workers[i].thread, NULL) == 0, "thread %zu", i);
    pthread_barrier_destroy(&work.start);
    unload(&fmus[0]);
    unload(&fmus[1]);
    free(expected);
    free(workers);
    printf("%zu threads, %zu instances in each: the same bits as in one thread; %.1f s\n", count, rounds,
           seconds() - began);
}

/* ---- Unloading ---- */

struct run {
    const struct fmu *fmu;
    atomic_int steps; /* so far */
    atomic_int enough;
    struct outputs outputs;
};

static void *move(void *argument)
{
    struct run *run = argument;
    fmi2Component c = start(run->fmu, NULL, push(0));
    for (int number = 0; !atomic_load(&run->enough); number++) {
        step(run->fmu, c, push(0), number);
        atomic_store(&run->steps, number + 1);
    }
    read_outputs(run->fmu, c, &run->outputs);
    run->fmu->fmi2FreeInstance(c);
    return NULL;
}

void unload_beside_a_run(int times)
{
    const struct about *const both[] = {&SET1, &RING12};
    for (size_t i = 0; i < 2; i++) {
        struct fmu stays, goes;
        struct outputs expected, found;
        load(&stays, both[i]);
        struct run run = {.fmu = &stays};
        pthread_t thread;
        CHECK(pthread_create(&thread, NULL, move, &run) == 0, "a thread");
        for (int k = 0; k < times; k++) {
            load(&goes, both[1 - i]);
            alone(&goes, push(0), 2, &found);
            /* It has moved before and it moves after. */
            const int before = atomic_load(&run.steps);
            unload(&goes);
            while (atomic_load(&run.steps) < before + 2)
                sched_yield();
        }
        atomic_store(&run.enough, 1);
        CHECK(pthread_join(thread, NULL) == 0, "a thread");
        const int steps = atomic_load(&run.steps);
        alone(&stays, push(0), steps, &expected);
        same(&stays, &expected, &run.outputs, "beside an unloaded library");
        unload(&stays);
        printf("%s was unloaded %d times beside %d steps of %s: the same bits as alone\n", both[1 - i]->name, times, steps,
               both[i]->name);
    }
}
