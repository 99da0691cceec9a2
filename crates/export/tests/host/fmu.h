/* An FMU as an importer in C holds it. */
#ifndef FMU_H
#define FMU_H

#include "fmi2Functions.h"
#include "functions.h" /* FUNCTIONS(F): F(name) for each function of fmi2Functions.h that is co-simulation's */
#include <stddef.h>

/* What is to be known about an FMU before it is loaded; tests/export/importer/ writes it down (about.h). */
struct about {
    const char *name;
    const char *library;   /* the file */
    const char *resources; /* the folder, as a URI with percent signs, without a slash at its end */
    const char *guid;
    fmi2ValueReference variables; /* so many; their references are the numbers below it */
    fmi2ValueReference input;     /* the slider's velocity */
    fmi2ValueReference friction;  /* an input that is not negative */
    fmi2ValueReference parameter; /* an initial velocity; fixed */
    fmi2ValueReference integer;   /* an output */
    size_t outputs;               /* Real ones */
    const fmi2ValueReference *output;
};

extern const struct about SET1, RING12, STICK_SLIP;

/* More outputs than any FMU here has. */
enum { MOST_OUTPUTS = 256 };

/* A loaded FMU: each function by its name and with its official type. */
struct fmu {
    const struct about *about;
    void *handle;
#define MEMBER(name) name##TYPE *name;
    FUNCTIONS(MEMBER)
#undef MEMBER
};

void load(struct fmu *fmu, const struct about *about);
/* Fails if the library is still in this process's memory afterwards. */
void unload(struct fmu *fmu);

/* What an instance has said, and the environment of its callbacks. */
struct log {
    const char *name; /* the instance's */
    size_t messages, errors;
};

/* A logger that fails where environment, name, status or category are not what they have to be. */
extern const fmi2CallbackLogger checking_logger;

/* Instantiates with copies of everything that are spoilt and freed when the call is back. NULLs stay NULLs; without
   a log the callbacks have no logger. */
fmi2Component instantiate(const struct fmu *fmu, const char *name, const char *guid, const char *resources,
                          struct log *log);

/* An instance that is initialized, pushed with a velocity, m/s. */
fmi2Component start(const struct fmu *fmu, struct log *log, fmi2Real push);
/* The way to the same state from any other. */
void initialize(const struct fmu *fmu, fmi2Component instance, fmi2Real push);

/* Runs end there at the latest, s. */
#define END 1e3
/* Lengths of communication steps, s. */
#define STEP 1e-4
/* The step that leads on from time number * STEP, and the input that is set before it: it varies, and differs between
   instances of different pushes, so that what one gets for another's is seen. */
void step(const struct fmu *fmu, fmi2Component instance, fmi2Real push, int number);
void drive(const struct fmu *fmu, fmi2Component instance, fmi2Real push, int number);
void advance(const struct fmu *fmu, fmi2Component instance, int number);

/* All that an instance puts out. */
struct outputs {
    fmi2Real real[MOST_OUTPUTS];
    fmi2Integer integer;
};
void read_outputs(const struct fmu *fmu, fmi2Component instance, struct outputs *outputs);
/* Fails unless they are the same bits. */
void same(const struct fmu *fmu, const struct outputs *expected, const struct outputs *found, const char *what);

/* What an instance of that push puts out after so many steps, where nothing else is going on. */
void alone(const struct fmu *fmu, fmi2Real push, int steps, struct outputs *outputs);

/* Different pushes; all of them let contacts stick and detach. */
enum { PUSHES = 8 };
fmi2Real push(size_t number);

/* ---- Checks ---- */

#define CHECK(condition, ...) ((condition) ? (void)0 : fail(__FILE__, __LINE__, #condition, __VA_ARGS__))
_Noreturn void fail(const char *file, int line, const char *condition, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Is the file mapped into this process? */
int is_mapped(const char *path);
double seconds(void);

/* ---- What main.c can be asked for ---- */

void calls(void);
void many(size_t instances, int steps);
void threads(size_t count, size_t rounds);
void unload_beside_a_run(int times);
/* The first rounds are not counted: the C library and the loader keep tables that grow at first. A bound of 0 is none;
   a round that leaks 16 bytes of its own shows that one is tight. */
void rounds(size_t count, size_t warm_up, long bound_kb, int leak);
void overrun(void);
void leak(void);

#endif
