/* A model of one state, x' = rate (u - x), for FMI 2.0; with -DFAULT_... it breaks one rule.
   With -DSTRICT it aborts on calls that the state machine of FMI 2.0, section 4.2.4, forbids. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xmmintrin.h>

typedef void *component;
typedef const char *text;
typedef struct {
    void (*logger)(void *, text, int, text, text, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} callbacks;

enum { OK = 0, WARNING = 1, DISCARD = 2, ERROR = 3, FATAL = 4 };
/* SET: an input was set during the run, and nothing may be read before the next step. */
enum { INSTANTIATED = 1, INITIALIZATION = 2, STEPPED = 4, SET = 8, FAILED = 16, ERRONEOUS = 32, TERMINATED = 64 };
#ifdef STRICT
#define ALLOWED(states) if (!(((instance *)c)->phase & (states))) abort()
#define FORBID(condition) if (condition) abort()
#else
#define ALLOWED(states)
#define FORBID(condition)
#endif

typedef struct {
    double x, u, rate;
    int count, mode;
} state;

typedef struct {
    state now;
    int entered, initialized, logging, phase;
    callbacks calls;
} instance;

static void tell(instance *self, const char *words) {
    self->calls.logger(self->calls.environment, "x", ERROR, "logStatusError", "%s", words);
}

#define GUID "{4c1c4b2e-58d6-4c25-8b0e-2f0a3f1f6f11}"
#define EXPORT __attribute__((visibility("default")))

static const state START = {0.5, 1.5,
#ifdef FAULT_start
                            0.75,
#else
                            0.25,
#endif
                            0, 2};

#ifdef FAULT_crash_at_load
__attribute__((constructor)) static void begin(void) { abort(); }
#endif
#ifdef FAULT_crash_at_exit
__attribute__((constructor)) static void begin(void) { atexit(abort); }
#endif
#ifdef FAULT_load
static __thread char large[1 << 22] __attribute__((tls_model("initial-exec")));
EXPORT char *where(void) { return large; }
#endif
#ifdef FAULT_undefined
extern int defined_nowhere(void);
#endif

EXPORT text fmi2GetTypesPlatform(void) {
#ifdef FAULT_types
    return "standard32";
#else
    return "default";
#endif
}

EXPORT text fmi2GetVersion(void) {
#ifdef FAULT_version
    return "2.1";
#else
    return "2.0";
#endif
}

EXPORT component fmi2Instantiate(text name, int kind, text guid, text location, const callbacks *calls, int visible,
                                 int logging) {
    (void)visible;
#ifdef FAULT_folder
    if (chdir("/") != 0) return NULL;
#endif
#ifdef FAULT_files
    dup(0);
#endif
#ifdef FAULT_handler
    signal(SIGFPE, SIG_IGN);
#endif
#ifdef FAULT_file
    fclose(fopen("notes.txt", "w"));
#endif
    if (kind != 1 || name == NULL || location == NULL) return NULL;
#ifndef FAULT_guid
    if (strcmp(guid, GUID) != 0) return NULL;
#endif
#ifdef FAULT_refuses
    calls->logger(calls->environment, name, ERROR, "logStatusError", "%s", "the licence is missing");
    return NULL;
#endif
#ifdef FAULT_null
    if (calls->allocate == NULL) return NULL;
#endif
#ifdef FAULT_null_crash
    calls->release(calls->allocate(1, 1));
#endif
#ifdef FAULT_location
    if (strncmp(location, "file:///", 8) != 0) return NULL;
#endif
#ifdef FAULT_space
    if (strchr(location, '%') != NULL) return NULL;
#endif
#ifdef FAULT_leak
    { volatile char *lost = malloc(1024); lost[0] = 1; }
#endif
#ifdef FAULT_leak_pages
    mmap(NULL, 8192, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
#endif
#ifdef FAULT_memory
    for (;;) memset(malloc(1 << 24), 1, 1 << 24);
#endif
#ifdef FAULT_daemon
    /* As daemon(3) does it: another session, and no parent that waits. */
    if (fork() == 0) {
        setsid();
        if (fork() == 0) for (;;) sleep(1000);
        _exit(0);
    }
#endif
#ifdef BRIEF_HELPER
    if (fork() == 0) { usleep(50000); _exit(0); }
#endif
#ifdef FAULT_fork
    if (fork() == 0) { for (;;) sleep(1000); }
#endif
#ifdef FAULT_prints
    printf("hello \033[31m from the library\n");
    fflush(stdout);
#endif
#ifdef FAULT_undefined
    if (visible == 77) return (component)(size_t)defined_nowhere();
#endif
#ifdef ONCE
    static int made_before;
    if (made_before++) return NULL;
#endif
#ifdef FAULT_shared
    static instance only;
    instance *made = &only;
#else
    instance *made = calloc(1, sizeof *made);
#endif
    made->now = START;
#ifdef FAULT_second
    static int number;
    made->now.x += number++;
#endif
#ifdef RANDOM
    made->now.x += getpid() * 1e-9 + (double)(size_t)made * 1e-18;
#endif
#ifdef RANDOM_UNSEEDED
    made->now.x += rand() * 1e-12;
#endif
    made->logging = logging;
    made->phase = INSTANTIATED;
    made->calls = *calls;
    return made;
}

EXPORT void fmi2FreeInstance(component c) {
#ifdef FAULT_free_null
    ((volatile instance *)c)->initialized = 1;
#endif
#ifdef FAULT_fatal
    if (c != NULL) abort();
#endif
#ifndef FAULT_shared
    free(c);
#endif
}

EXPORT int fmi2SetupExperiment(component c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    ALLOWED(INSTANTIATED);
    (void)c; (void)has_tolerance; (void)tolerance; (void)start; (void)has_stop; (void)stop;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(component c) {
    ALLOWED(INSTANTIATED);
    instance *self = c;
    self->phase = INITIALIZATION;
#ifdef FAULT_reset_phase
    if (self->entered) self->now.x += 1;
#endif
    self->entered = 1;
    return OK;
}
EXPORT int fmi2ExitInitializationMode(component c) {
    ALLOWED(INITIALIZATION);
    instance *self = c;
    self->initialized = 1;
    self->phase = STEPPED;
    return OK;
}

EXPORT int fmi2Terminate(component c) {
    ALLOWED(STEPPED | SET | FAILED);
    ((instance *)c)->phase = TERMINATED;
    return OK;
}

EXPORT int fmi2Reset(component c) {
    instance *self = c;
#ifdef FAULT_reset_value
    double before = self->now.rate;
#endif
#ifdef FAULT_reset
    self->now.count = 0;
#else
    self->now = START;
#endif
#ifdef FAULT_reset_phase
    if (self->entered && !self->initialized) return OK;
#endif
#ifdef FAULT_reset_value
    self->now.rate = before;
#endif
    self->entered = self->initialized = 0;
    self->phase = INSTANTIATED;
    return OK;
}

EXPORT int fmi2DoStep(component c, double time, double step, int keep) {
    ALLOWED(STEPPED | SET);
    (void)time;
    (void)keep;
    instance *self = c;
    self->phase = STEPPED;
#ifdef DISCARDS
    if (self->now.count == 3) {
        self->phase = FAILED;
        return DISCARD;
    }
#endif
#ifdef REFUSES_STEP
    if (self->now.rate != START.rate || self->now.u != START.u) {
        tell(self, "no step with such values");
        self->phase = ERRONEOUS;
        return ERROR;
    }
#endif
#ifdef FAULT_hang
    for (;;) sleep(1);
#endif
#ifdef FAULT_crash
    *(volatile int *)8 = 1;
#endif
#ifdef FAULT_fatal
    return FATAL;
#endif
#ifdef FAULT_exit
    exit(3);
#endif
#ifdef FAULT_fails
    tell(self, "no convergence");
    return ERROR;
#endif
#ifdef FAULT_steps
    if (step < 0.0625) {
        tell(self, "the step is too small");
        return ERROR;
    }
#endif
#ifdef FAULT_rounding
    _mm_setcsr(_mm_getcsr() | _MM_ROUND_UP);
#endif
#ifdef FAULT_logged
    if (self->logging) self->now.x += 1e-6;
#endif
#ifdef FAULT_follows
    if (self->now.u != START.u && self->now.count > 0) self->now.x = 0.0 / 0.0;
#endif
#ifdef FAULT_unset
    double *unset = malloc(sizeof *unset);
    if (*(volatile double *)unset == 77) usleep(1);
    free(unset);
#endif
    self->now.x += (self->now.u - self->now.x) * self->now.rate * step / (1 + self->now.rate * step);
#ifdef FAULT_nan
    if (self->now.count == 3) self->now.x = 0.0 / 0.0;
#endif
    self->now.count += 1;
    return OK;
}

EXPORT int fmi2GetReal(component c, const unsigned *which, size_t count, double *values) {
    ALLOWED(INITIALIZATION | STEPPED | FAILED | ERRONEOUS | TERMINATED);
    const state *now = &((instance *)c)->now;
    for (size_t i = 0; i < count; i++) {
        double all[] = {0, now->x, now->rate * (now->u - now->x), now->u, now->rate, 9.81};
#ifdef STRICT_MODES
        if (!((instance *)c)->initialized && which[i] >= 3) return ERROR;
#endif
#ifdef FAULT_unreadable
        if (which[i] == 2) return ERROR;
#endif
        values[i] = all[which[i]];
    }
#ifdef FAULT_array
    *(volatile double *)&values[count] = *(volatile double *)&values[count];
#endif
#ifdef FAULT_references
    *(volatile unsigned *)which = which[0];
#endif
    return OK;
}

EXPORT int fmi2GetInteger(component c, const unsigned *which, size_t count, int *values) {
    ALLOWED(INITIALIZATION | STEPPED | FAILED | ERRONEOUS | TERMINATED);
    for (size_t i = 0; i < count; i++) values[i] = which[i] == 0 ? ((instance *)c)->now.count : ((instance *)c)->now.mode;
    return OK;
}

EXPORT int fmi2GetBoolean(component c, const unsigned *which, size_t count, int *values) {
    ALLOWED(INITIALIZATION | STEPPED | FAILED | ERRONEOUS | TERMINATED);
    (void)which;
    for (size_t i = 0; i < count; i++) values[i] = ((instance *)c)->now.x != 0;
#ifdef FAULT_boolean
    for (size_t i = 0; i < count; i++) values[i] = -values[i];
#endif
    return OK;
}

EXPORT int fmi2GetString(component c, const unsigned *which, size_t count, text *values) {
    (void)c;
    (void)which;
    for (size_t i = 0; i < count; i++) values[i] = "a < b";
    return OK;
}

EXPORT int fmi2SetReal(component c, const unsigned *which, size_t count, const double *values) {
    instance *self = c;
    state *now = &self->now;
    ALLOWED(INSTANTIATED | INITIALIZATION | STEPPED | SET);
    if (self->phase == STEPPED) self->phase = SET;
    for (size_t i = 0; i < count; i++) {
        FORBID(self->phase == INSTANTIATED && which[i] == 3);
#ifdef FAULT_value
        if (which[i] == 4 && self->initialized) continue;
#endif
#if defined REFUSES || defined FAULT_silent
        if (which[i] == 4 && values[i] != START.rate) {
#ifdef REFUSES
            self->calls.logger(self->calls.environment, "x", ERROR, "logStatusError", "the rate is fixed to %f", START.rate);
#endif
            self->phase = ERRONEOUS;
            return ERROR;
        }
#endif
#ifdef REFUSES_INPUT
        if (which[i] == 3 && values[i] != START.u) {
            tell(self, "the input is fixed");
            self->phase = ERRONEOUS;
            return ERROR;
        }
#endif
#ifdef FAULT_kills
        if (which[i] == 4 && values[i] != START.rate) return FATAL;
#endif
        if (which[i] == 3) now->u = values[i];
#ifdef CLAMPS
        if (which[i] == 4) continue;
#endif
        if (which[i] == 4) now->rate = values[i];
#ifdef FAULT_only_first
        if (self->initialized) break;
#endif
    }
#ifdef CLAMPS
    tell(self, "the rate stays as it is");
    return WARNING;
#else
    return OK;
#endif
}

EXPORT int fmi2SetInteger(component c, const unsigned *which, size_t count, const int *values) {
    ALLOWED(INSTANTIATED | INITIALIZATION);
#ifdef MODES
    FORBID(values[0] != 2);
#endif
    for (size_t i = 0; i < count; i++) if (which[i] == 1) ((instance *)c)->now.mode = values[i];
    return OK;
}

EXPORT int fmi2SetString(component c, const unsigned *which, size_t count, const text *values) {
    ALLOWED(INSTANTIATED | INITIALIZATION);
    (void)c; (void)which; (void)count; (void)values;
    return OK;
}

EXPORT int fmi2SetDebugLogging(component c, int on, size_t count, const text *categories) {
    for (size_t i = 0; i < count; i++) if (strncmp(categories[i], "log", 3) != 0) return ERROR;
    ((instance *)c)->logging = on;
    return OK;
}

#ifndef FAULT_function
EXPORT int fmi2GetDirectionalDerivative(component c, const unsigned *unknown, size_t unknowns, const unsigned *known,
                                        size_t knowns, const double *direction, double *found) {
    ALLOWED(INITIALIZATION | STEPPED | SET | TERMINATED);
    const state *now = &((instance *)c)->now;
    for (size_t i = 0; i < unknowns; i++) {
        found[i] = 0;
        for (size_t j = 0; j < knowns; j++)
#ifdef FAULT_direction
            if (unknown[i] == 2 && known[j] == 3) found[i] += now->rate;
#else
            if (unknown[i] == 2 && known[j] == 3) found[i] += now->rate * direction[j];
#endif
    }
#ifdef FAULT_directional
    found[0] *= 1.1;
#endif
    return OK;
}
#endif

EXPORT int fmi2GetRealOutputDerivatives(component c, const unsigned *which, size_t count, const int *orders, double *found) {
    ALLOWED(STEPPED);
    const state *now = &((instance *)c)->now;
    (void)which; (void)orders;
    for (size_t i = 0; i < count; i++) found[i] = now->rate * (now->u - now->x);
#ifdef FAULT_output_derivative
    found[0] *= 0.1;
#endif
    return OK;
}

EXPORT int fmi2SetRealInputDerivatives(component c, const unsigned *which, size_t count, const int *orders, const double *rates) {
    ALLOWED(STEPPED | SET);
    (void)which; (void)count; (void)orders; (void)rates;
#ifdef FAULT_input_derivative
    ((instance *)c)->now.u += 0.1;
#else
    (void)c;
#endif
    return OK;
}

EXPORT int fmi2GetFMUstate(component c, void **saved) {
    if (*saved == NULL) *saved = malloc(sizeof(state));
    *(state *)*saved = ((instance *)c)->now;
    return OK;
}

EXPORT int fmi2SetFMUstate(component c, void *saved) {
    instance *self = c;
    self->phase = STEPPED;
#ifdef FAULT_state_input
    ((state *)saved)->u = self->now.u;
#endif
#ifdef FAULT_state_rate
    ((state *)saved)->rate = self->now.rate;
#endif
#ifndef FAULT_state
    self->now = *(state *)saved;
#endif
    return OK;
}

EXPORT int fmi2FreeFMUstate(component c, void **saved) {
    (void)c;
#ifdef FAULT_free_no_state
    *(volatile double *)*saved = 0;
#endif
    free(*saved);
#ifndef FAULT_pointer
    *saved = NULL;
#endif
    return OK;
}

EXPORT int fmi2SerializedFMUstateSize(component c, void *saved, size_t *size) {
    (void)c;
    (void)saved;
    *size = sizeof(state);
    return OK;
}

EXPORT int fmi2SerializeFMUstate(component c, void *saved, char *bytes, size_t size) {
    (void)c;
    memcpy(bytes, saved, size);
    return OK;
}

EXPORT int fmi2DeSerializeFMUstate(component c, const char *bytes, size_t size, void **saved) {
    (void)c;
    *saved = malloc(size);
    memcpy(*saved, bytes, size);
#ifdef FAULT_serialized
    ((state *)*saved)->x += 1e-9;
#endif
    return OK;
}

#define REFUSED(name) EXPORT int name(void) { return ERROR; }
REFUSED(fmi2SetBoolean)
REFUSED(fmi2CancelStep)
REFUSED(fmi2GetStatus)
REFUSED(fmi2GetRealStatus)
REFUSED(fmi2GetIntegerStatus)
REFUSED(fmi2GetBooleanStatus)
REFUSED(fmi2GetStringStatus)
