#include "fmu.h"
#include "about.h" /* SET1, RING12, STICK_SLIP */
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

_Noreturn void fail(const char *file, int line, const char *condition, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "%s:%d: %s does not hold: ", file, line, condition);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    /* At once: other threads may be in the middle of something. */
    _Exit(1);
}

double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- The library ---- */

static void *symbol(void *handle, const char *name)
{
    void *found = dlsym(handle, name);
    CHECK(found, "%s is missing: %s", name, dlerror());
    return found;
}

void load(struct fmu *fmu, const struct about *about)
{
    fmu->about = about;
    fmu->handle = dlopen(about->library, RTLD_NOW | RTLD_LOCAL);
    CHECK(fmu->handle, "%s", dlerror());
    void *found;
    /* Copied, since ISO C does not convert between pointers to data and to functions. */
#define FIND(name)                       \
    found = symbol(fmu->handle, #name); \
    memcpy(&fmu->name, &found, sizeof found);
    FUNCTIONS(FIND)
#undef FIND
}

void unload(struct fmu *fmu)
{
    CHECK(dlclose(fmu->handle) == 0, "%s", dlerror());
    CHECK(!is_mapped(fmu->about->library), "%s is still mapped", fmu->about->library);
    memset(fmu, 0, sizeof *fmu);
}

int is_mapped(const char *path)
{
    FILE *maps = fopen("/proc/self/maps", "r");
    CHECK(maps, "no /proc/self/maps");
    char line[4096];
    int found = 0;
    while (!found && fgets(line, sizeof line, maps))
        found = strstr(line, path) != NULL;
    fclose(maps);
    return found;
}

/* ---- Instances ---- */

static void check_message(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                          fmi2String message, ...)
{
    struct log *log = environment;
    CHECK(log, "the environment got lost");
    CHECK(strcmp(name, log->name) == 0, "%s instead of %s", name, log->name);
    CHECK(strcmp(message, "%s") == 0, "the message is the format: %s", message);
    va_list arguments;
    va_start(arguments, message);
    const char *text = va_arg(arguments, const char *);
    va_end(arguments);
    CHECK(strlen(text) > 5, "no reason is given: %s", text);
    const char *expected = status == fmi2OK ? "logEvents" : status == fmi2Warning ? "logStatusWarning" : "logStatusError";
    CHECK(strcmp(category, expected) == 0, "%s: %s", category, text);
    log->messages += 1;
    log->errors += status == fmi2Error;
}

const fmi2CallbackLogger checking_logger = check_message;

/* The model description says that these are not used. */
static void *no_memory(size_t count, size_t size)
{
    fail(__FILE__, __LINE__, "0", "allocateMemory was called: %zu × %zu", count, size);
}

static void free_nothing(void *memory)
{
    fail(__FILE__, __LINE__, "0", "freeMemory was called: %p", memory);
}

static char *copy_of(const char *text)
{
    char *copy = text ? malloc(strlen(text) + 1) : NULL;
    return copy ? strcpy(copy, text) : NULL;
}

static void spoil(void *memory, size_t size)
{
    if (memory)
        memset(memory, 0xA5, size);
    /* The bytes are written though they are freed right away. */
    __asm__ volatile("" : : "r"(memory) : "memory");
    free(memory);
}

fmi2Component instantiate(const struct fmu *fmu, const char *name, const char *guid, const char *resources,
                          struct log *log)
{
    char *texts[] = {copy_of(name), copy_of(guid), copy_of(resources)};
    fmi2CallbackFunctions *callbacks = malloc(sizeof *callbacks);
    CHECK(callbacks, "no memory");
    callbacks->logger = log ? checking_logger : NULL;
    callbacks->allocateMemory = no_memory;
    callbacks->freeMemory = free_nothing;
    callbacks->stepFinished = NULL;
    callbacks->componentEnvironment = log;
    fmi2Component instance =
        fmu->fmi2Instantiate(texts[0], fmi2CoSimulation, texts[1], texts[2], callbacks, fmi2False, fmi2True);
    for (size_t i = 0; i < 3; i++)
        spoil(texts[i], texts[i] ? strlen(texts[i]) : 0);
    spoil(callbacks, sizeof *callbacks);
    return instance;
}

void initialize(const struct fmu *fmu, fmi2Component instance, fmi2Real push)
{
    CHECK(fmu->fmi2Reset(instance) == fmi2OK, "reset");
    CHECK(fmu->fmi2SetupExperiment(instance, fmi2False, 0.0, 0.0, fmi2True, END) == fmi2OK, "set up");
    CHECK(fmu->fmi2EnterInitializationMode(instance) == fmi2OK, "enter");
    CHECK(fmu->fmi2SetReal(instance, &fmu->about->parameter, 1, &push) == fmi2OK, "push");
    CHECK(fmu->fmi2ExitInitializationMode(instance) == fmi2OK, "exit");
}

fmi2Component start(const struct fmu *fmu, struct log *log, fmi2Real push)
{
    const struct about *about = fmu->about;
    fmi2Component instance = instantiate(fmu, log ? log->name : about->name, about->guid, about->resources, log);
    CHECK(instance, "%s cannot be instantiated", about->name);
    initialize(fmu, instance, push);
    return instance;
}

void drive(const struct fmu *fmu, fmi2Component instance, fmi2Real push, int number)
{
    const fmi2Real velocity = 0.025 + 0.001 * sin(0.1 * number + push);
    CHECK(fmu->fmi2SetReal(instance, &fmu->about->input, 1, &velocity) == fmi2OK, "the velocity of step %d", number);
}

void advance(const struct fmu *fmu, fmi2Component instance, int number)
{
    CHECK(fmu->fmi2DoStep(instance, number * STEP, STEP, fmi2False) == fmi2OK, "step %d", number);
}

void step(const struct fmu *fmu, fmi2Component instance, fmi2Real push, int number)
{
    drive(fmu, instance, push, number);
    advance(fmu, instance, number);
}

void read_outputs(const struct fmu *fmu, fmi2Component instance, struct outputs *outputs)
{
    const struct about *about = fmu->about;
    /* Padding is compared as well. */
    memset(outputs, 0, sizeof *outputs);
    CHECK(about->outputs <= MOST_OUTPUTS, "%zu outputs", about->outputs);
    CHECK(fmu->fmi2GetReal(instance, about->output, about->outputs, outputs->real) == fmi2OK, "real outputs");
    CHECK(fmu->fmi2GetInteger(instance, &about->integer, 1, &outputs->integer) == fmi2OK, "the integer output");
}

void same(const struct fmu *fmu, const struct outputs *expected, const struct outputs *found, const char *what)
{
    for (size_t i = 0; i < fmu->about->outputs; i++)
        CHECK(memcmp(&expected->real[i], &found->real[i], sizeof(fmi2Real)) == 0, "%s: %s, output %zu: %.17g, not %.17g",
              fmu->about->name, what, i, found->real[i], expected->real[i]);
    CHECK(expected->integer == found->integer, "%s: %s: %d, not %d", fmu->about->name, what, found->integer,
          expected->integer);
}

void alone(const struct fmu *fmu, fmi2Real push, int steps, struct outputs *outputs)
{
    fmi2Component instance = start(fmu, NULL, push);
    for (int number = 0; number < steps; number++)
        step(fmu, instance, push, number);
    read_outputs(fmu, instance, outputs);
    fmu->fmi2FreeInstance(instance);
}

fmi2Real push(size_t number)
{
    return 0.1 * (1.0 + (double)(number % PUSHES));
}
