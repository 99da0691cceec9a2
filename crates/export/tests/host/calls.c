/* Every function with good arguments and with bad ones. */
#include "fmu.h"
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* How often each function was called with good and with bad arguments. */
static struct tally {
    const char *name;
    size_t good, bad;
} tallies[] = {
#define TALLY(name) {#name, 0, 0},
    FUNCTIONS(TALLY)
#undef TALLY
};
enum { TALLIES = sizeof tallies / sizeof *tallies };

static const char *const STATUSES[] = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};

static void count(const char *name, int is_good)
{
    size_t i = 0;
    while (i < TALLIES && strcmp(tallies[i].name, name) != 0)
        i++;
    CHECK(i < TALLIES, "%s is none of FMI's functions", name);
    tallies[i].good += is_good != 0;
    tallies[i].bad += is_good == 0;
}

static void expect(int line, const char *name, fmi2Status expected, fmi2Status found)
{
    CHECK(found == expected, "line %d: %s: %s instead of %s", line, name,
          (unsigned)found < 6 ? STATUSES[found] : "no status", STATUSES[expected]);
    count(name, expected != fmi2Error);
}

#define EXPECT(status, function, arguments) expect(__LINE__, #function, status, fmu->function arguments)

/* A refusal gives its reason once; the instance is as good as new afterwards. */
#define REFUSED(function, arguments)                                                       \
    do {                                                                                   \
        size_t before = log->errors;                                                       \
        EXPECT(fmi2Error, function, arguments);                                            \
        CHECK(log->errors == before + 1, "%s gives %zu reasons", #function, log->errors - before); \
        initialize(fmu, c, push(0));                                                       \
    } while (0)

/* In the phase right after fmi2Instantiate. */
#define REFUSED_AT_FIRST(function, arguments)                \
    do {                                                     \
        CHECK(fmu->fmi2Reset(c) == fmi2OK, "reset");         \
        EXPECT(fmi2Error, function, arguments);              \
    } while (0)

static void no_instance(const struct fmu *fmu)
{
    fmi2ValueReference reference = 0;
    fmi2Real real = 0.0;
    fmi2Integer integer = 0;
    fmi2Boolean boolean = 0;
    fmi2String string = NULL;
    fmi2FMUstate state = NULL;
    fmi2Status status = fmi2OK;
    fmi2Byte byte = 0;
    size_t size = 0;
    EXPECT(fmi2Error, fmi2SetDebugLogging, (NULL, fmi2True, 0, NULL));
    EXPECT(fmi2Error, fmi2SetupExperiment, (NULL, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    EXPECT(fmi2Error, fmi2EnterInitializationMode, (NULL));
    EXPECT(fmi2Error, fmi2ExitInitializationMode, (NULL));
    EXPECT(fmi2Error, fmi2Terminate, (NULL));
    EXPECT(fmi2Error, fmi2Reset, (NULL));
    EXPECT(fmi2Error, fmi2GetReal, (NULL, &reference, 1, &real));
    EXPECT(fmi2Error, fmi2GetInteger, (NULL, &reference, 1, &integer));
    EXPECT(fmi2Error, fmi2GetBoolean, (NULL, &reference, 1, &boolean));
    EXPECT(fmi2Error, fmi2GetString, (NULL, &reference, 1, &string));
    EXPECT(fmi2Error, fmi2SetReal, (NULL, &reference, 1, &real));
    EXPECT(fmi2Error, fmi2SetInteger, (NULL, &reference, 1, &integer));
    EXPECT(fmi2Error, fmi2SetBoolean, (NULL, &reference, 1, &boolean));
    EXPECT(fmi2Error, fmi2SetString, (NULL, &reference, 1, &string));
    EXPECT(fmi2Error, fmi2GetFMUstate, (NULL, &state));
    EXPECT(fmi2Error, fmi2SetFMUstate, (NULL, state));
    EXPECT(fmi2Error, fmi2FreeFMUstate, (NULL, &state));
    EXPECT(fmi2Error, fmi2SerializedFMUstateSize, (NULL, state, &size));
    EXPECT(fmi2Error, fmi2SerializeFMUstate, (NULL, state, &byte, 1));
    EXPECT(fmi2Error, fmi2DeSerializeFMUstate, (NULL, &byte, 1, &state));
    EXPECT(fmi2Error, fmi2GetDirectionalDerivative, (NULL, &reference, 1, &reference, 1, &real, &real));
    EXPECT(fmi2Error, fmi2SetRealInputDerivatives, (NULL, &reference, 1, &integer, &real));
    EXPECT(fmi2Error, fmi2GetRealOutputDerivatives, (NULL, &reference, 1, &integer, &real));
    EXPECT(fmi2Error, fmi2DoStep, (NULL, 0.0, STEP, fmi2False));
    EXPECT(fmi2Error, fmi2CancelStep, (NULL));
    EXPECT(fmi2Error, fmi2GetStatus, (NULL, fmi2DoStepStatus, &status));
    EXPECT(fmi2Error, fmi2GetRealStatus, (NULL, fmi2LastSuccessfulTime, &real));
    EXPECT(fmi2Error, fmi2GetIntegerStatus, (NULL, fmi2DoStepStatus, &integer));
    EXPECT(fmi2Error, fmi2GetBooleanStatus, (NULL, fmi2Terminated, &boolean));
    EXPECT(fmi2Error, fmi2GetStringStatus, (NULL, fmi2PendingStatus, &string));
    fmu->fmi2FreeInstance(NULL);
    count("fmi2FreeInstance", 0);
}

static void inquiry(const struct fmu *fmu)
{
    CHECK(strcmp(fmu->fmi2GetVersion(), fmi2Version) == 0, "%s", fmu->fmi2GetVersion());
    CHECK(strcmp(fmu->fmi2GetTypesPlatform(), fmi2TypesPlatform) == 0, "%s", fmu->fmi2GetTypesPlatform());
    count("fmi2GetVersion", 1);
    count("fmi2GetTypesPlatform", 1);
}

static void instantiation(const struct fmu *fmu)
{
    const struct about *about = fmu->about;
    struct log log = {about->name, 0, 0};
    char slash[4096], local[4096], one[4096], missing[4096];
    const char *path = about->resources + strlen("file://");
    CHECK(strchr(path, '%') && !strchr(path, ' '), "the folder's name needs no percent signs: %s", path);
    snprintf(slash, sizeof slash, "%s/", about->resources);
    snprintf(local, sizeof local, "file://localhost%s", path);
    snprintf(one, sizeof one, "file:%s", path);
    snprintf(missing, sizeof missing, "%s/missing", about->resources);

    const char *const good[] = {about->resources, slash, local, one, "", NULL};
    struct outputs expected, found;
    alone(fmu, push(0), 5, &expected);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        /* With a logger and without. */
        fmi2Component c = instantiate(fmu, about->name, about->guid, good[i], i % 2 ? NULL : &log);
        CHECK(c, "%s", good[i] ? good[i] : "NULL");
        initialize(fmu, c, push(0));
        for (int number = 0; number < 5; number++)
            step(fmu, c, push(0), number);
        read_outputs(fmu, c, &found);
        same(fmu, &expected, &found, "found through another spelling");
        fmu->fmi2FreeInstance(c);
        count("fmi2Instantiate", 1);
        count("fmi2FreeInstance", 1);
    }
    CHECK(log.errors == 0, "%zu errors", log.errors);

    /* Nobody to talk to: refusals are silent, and everything goes on. */
    fmi2Component deaf = fmu->fmi2Instantiate("deaf", fmi2CoSimulation, about->guid, NULL, NULL, fmi2True, fmi2True);
    CHECK(deaf, "without callbacks");
    CHECK(fmu->fmi2DoStep(deaf, 0.0, STEP, fmi2False) == fmi2Error, "a step before the start");
    initialize(fmu, deaf, push(0));
    for (int number = 0; number < 5; number++)
        step(fmu, deaf, push(0), number);
    read_outputs(fmu, deaf, &found);
    same(fmu, &expected, &found, "without callbacks");
    fmu->fmi2FreeInstance(deaf);

    const struct {
        const char *name, *guid, *resources;
        fmi2Type type;
    } bad[] = {
        {NULL, about->guid, about->resources, fmi2CoSimulation},
        {"", about->guid, about->resources, fmi2CoSimulation},
        {"x", NULL, about->resources, fmi2CoSimulation},
        {"x", "", about->resources, fmi2CoSimulation},
        {"x", "\xff\xfe", about->resources, fmi2CoSimulation},
        {"x", "{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}", about->resources, fmi2CoSimulation},
        {"x", about->guid, "http://example.org/", fmi2CoSimulation},
        {"x", about->guid, "file://elsewhere/", fmi2CoSimulation},
        {"x", about->guid, "file:///%4", fmi2CoSimulation},
        {"x", about->guid, "file:///%00", fmi2CoSimulation},
        {"x", about->guid, "resources", fmi2CoSimulation},
        {"x", about->guid, missing, fmi2CoSimulation},
        {"x", about->guid, about->resources, fmi2ModelExchange},
        {"x", about->guid, about->resources, (fmi2Type)77},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct log refusal = {bad[i].name ? bad[i].name : "", 0, 0};
        const fmi2CallbackFunctions listening = {checking_logger, NULL, NULL, NULL, &refusal};
        const fmi2CallbackFunctions mute = {NULL, NULL, NULL, NULL, NULL};
        const fmi2CallbackFunctions *const callbacks[] = {&listening, &mute, NULL};
        for (size_t k = 0; k < 3; k++)
            CHECK(!fmu->fmi2Instantiate(bad[i].name, bad[i].type, bad[i].guid, bad[i].resources, callbacks[k], 0, 0),
                  "bad arguments %zu", i);
        CHECK(refusal.errors == 1, "bad arguments %zu: %zu reasons", i, refusal.errors);
        count("fmi2Instantiate", 0);
    }
}

static void logging(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    const fmi2String known[] = {"logStatusError", "logEvents"}, unknown[] = {"logAll", "logNothing"};
    const fmi2String null[] = {"logAll", NULL};
    EXPECT(fmi2OK, fmi2SetDebugLogging, (c, fmi2True, 0, NULL));
    EXPECT(fmi2OK, fmi2SetDebugLogging, (c, fmi2False, 2, known));
    EXPECT(fmi2Warning, fmi2SetDebugLogging, (c, fmi2True, 2, unknown));
    REFUSED(fmi2SetDebugLogging, (c, fmi2True, 1, NULL));
    REFUSED(fmi2SetDebugLogging, (c, fmi2True, 2, null));
    REFUSED(fmi2SetDebugLogging, (c, fmi2True, SIZE_MAX, known));
}

static void life(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    REFUSED_AT_FIRST(fmi2SetupExperiment, (c, fmi2False, 0.0, NAN, fmi2False, 0.0));
    REFUSED_AT_FIRST(fmi2SetupExperiment, (c, fmi2False, 0.0, INFINITY, fmi2False, 0.0));
    REFUSED_AT_FIRST(fmi2SetupExperiment, (c, fmi2False, 0.0, 0.0, fmi2True, NAN));
    REFUSED_AT_FIRST(fmi2SetupExperiment, (c, fmi2False, 0.0, 1.0, fmi2True, 0.0));
    REFUSED_AT_FIRST(fmi2ExitInitializationMode, (c));
    REFUSED_AT_FIRST(fmi2Terminate, (c));
    REFUSED_AT_FIRST(fmi2DoStep, (c, 0.0, STEP, fmi2False));
    EXPECT(fmi2OK, fmi2Reset, (c));
    EXPECT(fmi2OK, fmi2SetupExperiment, (c, fmi2False, NAN, 0.0, fmi2False, NAN));
    EXPECT(fmi2OK, fmi2EnterInitializationMode, (c));
    EXPECT(fmi2OK, fmi2ExitInitializationMode, (c));
    REFUSED(fmi2EnterInitializationMode, (c));
    REFUSED(fmi2ExitInitializationMode, (c));
    REFUSED(fmi2SetupExperiment, (c, fmi2False, 0.0, 0.0, fmi2False, 0.0));
    EXPECT(fmi2OK, fmi2Terminate, (c));
    REFUSED(fmi2DoStep, (c, 0.0, STEP, fmi2False));
}

static void variables(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    const struct about *about = fmu->about;
    const fmi2ValueReference none = about->variables;
    const fmi2ValueReference two[] = {about->output[0], none}, huge = UINT32_MAX, integer = about->integer;
    fmi2Real real[2] = {0.0, 0.0};
    fmi2Integer whole[2] = {0, 0};
    fmi2Boolean boolean = 0;
    fmi2String string = NULL;
    /* An address that a double cannot have. */
    union {
        fmi2Real aligned[2];
        char bytes[16];
    } room = {{0.0, 0.0}};
    void *odd = &room.bytes[1];

    EXPECT(fmi2OK, fmi2GetReal, (c, about->output, about->outputs, (fmi2Real[MOST_OUTPUTS]){0}));
    EXPECT(fmi2OK, fmi2GetReal, (c, NULL, 0, NULL));
    REFUSED(fmi2GetReal, (c, NULL, 1, real));
    REFUSED(fmi2GetReal, (c, about->output, 1, NULL));
    REFUSED(fmi2GetReal, (c, about->output, SIZE_MAX, real));
    REFUSED(fmi2GetReal, (c, about->output, SIZE_MAX / sizeof *real + 2, real));
    REFUSED(fmi2GetReal, (c, about->output, 1, odd));
    REFUSED(fmi2GetReal, (c, odd, 1, real));
    REFUSED(fmi2GetReal, (c, &none, 1, real));
    REFUSED(fmi2GetReal, (c, &huge, 1, real));
    REFUSED(fmi2GetReal, (c, two, 2, real));
    REFUSED(fmi2GetReal, (c, &integer, 1, real));

    EXPECT(fmi2OK, fmi2GetInteger, (c, &integer, 1, whole));
    EXPECT(fmi2OK, fmi2GetInteger, (c, NULL, 0, NULL));
    REFUSED(fmi2GetInteger, (c, NULL, 1, whole));
    REFUSED(fmi2GetInteger, (c, &integer, 1, NULL));
    REFUSED(fmi2GetInteger, (c, about->output, 1, whole));
    REFUSED(fmi2GetInteger, (c, &none, 1, whole));
    REFUSED(fmi2GetInteger, (c, &huge, 1, whole));

    EXPECT(fmi2OK, fmi2GetBoolean, (c, NULL, 0, NULL));
    EXPECT(fmi2OK, fmi2GetString, (c, NULL, 0, NULL));
    REFUSED(fmi2GetBoolean, (c, &integer, 1, &boolean));
    REFUSED(fmi2GetBoolean, (c, NULL, 1, NULL));
    REFUSED(fmi2GetString, (c, &integer, 1, &string));
    REFUSED(fmi2GetString, (c, NULL, 1, NULL));

    const fmi2Real velocity[2] = {0.03, 0.5}, not_a_number = NAN, infinite = -INFINITY, negative = -1e-9;
    EXPECT(fmi2OK, fmi2SetReal, (c, &about->input, 1, velocity));
    EXPECT(fmi2OK, fmi2SetReal, (c, NULL, 0, NULL));
    CHECK(fmu->fmi2GetReal(c, &about->input, 1, real) == fmi2OK && real[0] == velocity[0], "%g", real[0]);
    REFUSED(fmi2SetReal, (c, NULL, 1, velocity));
    REFUSED(fmi2SetReal, (c, &about->input, 1, NULL));
    REFUSED(fmi2SetReal, (c, &about->input, SIZE_MAX, velocity));
    REFUSED(fmi2SetReal, (c, &about->input, 1, odd));
    REFUSED(fmi2SetReal, (c, &about->input, 1, &not_a_number));
    REFUSED(fmi2SetReal, (c, &about->input, 1, &infinite));
    REFUSED(fmi2SetReal, (c, &about->friction, 1, &negative));
    REFUSED(fmi2SetReal, (c, about->output, 1, velocity));
    REFUSED(fmi2SetReal, (c, &about->parameter, 1, velocity));
    REFUSED(fmi2SetReal, (c, &integer, 1, velocity));
    REFUSED(fmi2SetReal, (c, &none, 1, velocity));
    REFUSED(fmi2SetReal, (c, &huge, 1, velocity));

    /* All or nothing. */
    const fmi2ValueReference good_and_bad[] = {about->input, none};
    CHECK(fmu->fmi2GetReal(c, &about->input, 1, &real[0]) == fmi2OK, "before");
    EXPECT(fmi2Error, fmi2SetReal, (c, good_and_bad, 2, velocity));
    CHECK(fmu->fmi2GetReal(c, &about->input, 1, &real[1]) == fmi2OK, "after");
    CHECK(real[0] == real[1] && real[0] != velocity[0], "%g became %g", real[0], real[1]);
    initialize(fmu, c, push(0));

    EXPECT(fmi2OK, fmi2SetInteger, (c, NULL, 0, NULL));
    EXPECT(fmi2OK, fmi2SetBoolean, (c, NULL, 0, NULL));
    EXPECT(fmi2OK, fmi2SetString, (c, NULL, 0, NULL));
    REFUSED(fmi2SetInteger, (c, &integer, 1, whole));
    REFUSED(fmi2SetInteger, (c, NULL, 1, whole));
    REFUSED(fmi2SetInteger, (c, &integer, 1, NULL));
    REFUSED(fmi2SetInteger, (c, &none, 1, whole));
    REFUSED(fmi2SetBoolean, (c, &integer, 1, &boolean));
    REFUSED(fmi2SetBoolean, (c, NULL, 1, NULL));
    REFUSED(fmi2SetString, (c, &integer, 1, &string));
    REFUSED(fmi2SetString, (c, NULL, 1, NULL));
}

static void saved_states(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    struct outputs expected, found;
    fmi2FMUstate state = NULL, read = NULL, untouched = NULL;
    size_t size = 0;
    for (int number = 0; number < 5; number++)
        step(fmu, c, push(0), number);
    EXPECT(fmi2OK, fmi2GetFMUstate, (c, &state));
    const fmi2FMUstate first = state;
    EXPECT(fmi2OK, fmi2GetFMUstate, (c, &state));
    CHECK(state == first, "a state that is written over stays where it is");
    EXPECT(fmi2OK, fmi2SerializedFMUstateSize, (c, state, &size));
    CHECK(size > 0, "%zu bytes", size);
    /* As long as was said, to the byte, so that one too many would be seen. */
    fmi2Byte *bytes = malloc(size), *more = malloc(size + 100), *less = malloc(size - 1);
    CHECK(bytes && more && less, "no memory");
    memset(more, 0x5A, size + 100);
    memset(less, 0x5A, size - 1);
    EXPECT(fmi2OK, fmi2SerializeFMUstate, (c, state, bytes, size));
    EXPECT(fmi2OK, fmi2SerializeFMUstate, (c, state, more, size + 100));
    CHECK(memcmp(bytes, more, size) == 0, "more room leads to other bytes");
    for (size_t i = size; i < size + 100; i++)
        CHECK(more[i] == 0x5A, "byte %zu behind the state was written", i - size);
    EXPECT(fmi2OK, fmi2DeSerializeFMUstate, (c, bytes, size, &read));
    for (int number = 5; number < 10; number++)
        step(fmu, c, push(0), number);
    read_outputs(fmu, c, &expected);
    const fmi2FMUstate both[] = {state, read};
    for (size_t i = 0; i < 2; i++) {
        EXPECT(fmi2OK, fmi2SetFMUstate, (c, both[i]));
        for (int number = 5; number < 10; number++)
            step(fmu, c, push(0), number);
        read_outputs(fmu, c, &found);
        same(fmu, &expected, &found, "from a saved state");
    }

    REFUSED(fmi2GetFMUstate, (c, NULL));
    REFUSED(fmi2SetFMUstate, (c, NULL));
    REFUSED(fmi2SerializedFMUstateSize, (c, NULL, &size));
    REFUSED(fmi2SerializedFMUstateSize, (c, state, NULL));
    REFUSED(fmi2SerializeFMUstate, (c, NULL, bytes, size));
    REFUSED(fmi2SerializeFMUstate, (c, state, NULL, size));
    REFUSED(fmi2SerializeFMUstate, (c, state, bytes, 0));
    REFUSED(fmi2SerializeFMUstate, (c, state, less, size - 1));
    REFUSED(fmi2SerializeFMUstate, (c, state, bytes, SIZE_MAX));
    for (size_t i = 0; i < size - 1; i++)
        CHECK(less[i] == 0x5A, "byte %zu was written though there is no room for all", i);
    REFUSED(fmi2DeSerializeFMUstate, (c, NULL, size, &untouched));
    REFUSED(fmi2DeSerializeFMUstate, (c, bytes, 0, &untouched));
    REFUSED(fmi2DeSerializeFMUstate, (c, bytes, size - 1, &untouched));
    REFUSED(fmi2DeSerializeFMUstate, (c, more, size + 1, &untouched));
    REFUSED(fmi2DeSerializeFMUstate, (c, bytes, SIZE_MAX, &untouched));
    REFUSED(fmi2DeSerializeFMUstate, (c, bytes, size, NULL));
    bytes[size / 2] ^= 1;
    REFUSED(fmi2DeSerializeFMUstate, (c, bytes, size, &untouched));
    CHECK(!untouched, "a refusal wrote a state");

    /* A state outlives what was done to its instance meanwhile. */
    EXPECT(fmi2OK, fmi2SetFMUstate, (c, state));
    for (int number = 5; number < 10; number++)
        step(fmu, c, push(0), number);
    read_outputs(fmu, c, &found);
    same(fmu, &expected, &found, "from a saved state after errors");

    EXPECT(fmi2OK, fmi2FreeFMUstate, (c, &state));
    EXPECT(fmi2OK, fmi2FreeFMUstate, (c, &read));
    CHECK(!state && !read, "freed states stay behind");
    EXPECT(fmi2OK, fmi2FreeFMUstate, (c, &state));
    EXPECT(fmi2OK, fmi2FreeFMUstate, (c, NULL));
    initialize(fmu, c, push(0));
    free(bytes);
    free(more);
    free(less);
}

/* Values are the matter of other tests; here is what C may get wrong. */
static void derivatives(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    const struct about *about = fmu->about;
    const fmi2Integer one = 1;
    const fmi2Real seed = 1.0;
    fmi2Real real = 0.0;
    EXPECT(fmi2OK, fmi2GetDirectionalDerivative, (c, NULL, 0, NULL, 0, NULL, NULL));
    EXPECT(fmi2OK, fmi2SetRealInputDerivatives, (c, NULL, 0, NULL, NULL));
    EXPECT(fmi2OK, fmi2GetRealOutputDerivatives, (c, NULL, 0, NULL, NULL));

    /* As long as they need to be, so that a sanitizer sees a place too many. */
    const size_t count = about->outputs;
    fmi2Real *const found = malloc(count * sizeof *found);
    fmi2Integer *const orders = malloc(count * sizeof *orders);
    CHECK(found != NULL && orders != NULL, "no memory");
    for (size_t i = 0; i < count; i++) {
        orders[i] = 1;
    }
    EXPECT(fmi2OK, fmi2GetDirectionalDerivative, (c, about->output, count, &about->input, 1, &seed, found));
    EXPECT(fmi2OK, fmi2GetRealOutputDerivatives, (c, about->output, count, orders, found));
    EXPECT(fmi2OK, fmi2SetRealInputDerivatives, (c, &about->input, 1, &one, &seed));
    EXPECT(fmi2OK, fmi2DoStep, (c, 0.0, STEP, fmi2False));
    EXPECT(fmi2OK, fmi2GetRealOutputDerivatives, (c, about->output, count, orders, found));
    for (size_t i = 0; i < count; i++) {
        CHECK(isfinite(found[i]), "derivative %zu", i);
    }
    orders[count - 1] = 2;
    REFUSED(fmi2GetRealOutputDerivatives, (c, about->output, count, orders, found));
    REFUSED(fmi2SetRealInputDerivatives, (c, &about->input, 1, &orders[count - 1], &seed));
    REFUSED(fmi2SetRealInputDerivatives, (c, about->output, 1, &one, &seed));
    REFUSED(fmi2GetDirectionalDerivative, (c, &about->input, 1, &about->input, 1, &seed, &real));
    free(found);
    free(orders);
    REFUSED(fmi2GetDirectionalDerivative, (c, NULL, 1, &about->input, 1, &seed, &real));
    REFUSED(fmi2GetDirectionalDerivative, (c, about->output, 1, NULL, 1, &seed, &real));
    REFUSED(fmi2GetDirectionalDerivative, (c, about->output, 1, &about->input, 1, NULL, &real));
    REFUSED(fmi2GetDirectionalDerivative, (c, about->output, 1, &about->input, 1, &seed, NULL));
    REFUSED(fmi2GetDirectionalDerivative, (c, about->output, SIZE_MAX, &about->input, 1, &seed, &real));
    REFUSED(fmi2SetRealInputDerivatives, (c, NULL, 1, &one, &seed));
    REFUSED(fmi2SetRealInputDerivatives, (c, &about->input, 1, NULL, &seed));
    REFUSED(fmi2SetRealInputDerivatives, (c, &about->input, 1, &one, NULL));
    REFUSED(fmi2SetRealInputDerivatives, (c, &about->input, SIZE_MAX, &one, &seed));
    REFUSED(fmi2GetRealOutputDerivatives, (c, NULL, 1, &one, &real));
    REFUSED(fmi2GetRealOutputDerivatives, (c, about->output, 1, NULL, &real));
    REFUSED(fmi2GetRealOutputDerivatives, (c, about->output, 1, &one, NULL));
    REFUSED(fmi2GetRealOutputDerivatives, (c, about->output, SIZE_MAX, &one, &real));
}

static void steps(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    EXPECT(fmi2OK, fmi2DoStep, (c, 0.0, STEP, fmi2False));
    EXPECT(fmi2OK, fmi2DoStep, (c, STEP, STEP, fmi2True));
    EXPECT(fmi2Warning, fmi2DoStep, (c, 2 * STEP, 0.0, fmi2True));
    fmi2Real time = NAN;
    EXPECT(fmi2OK, fmi2GetRealStatus, (c, fmi2LastSuccessfulTime, &time));
    CHECK(fabs(time - 2 * STEP) < 1e-12, "%.17g s", time);
    REFUSED(fmi2DoStep, (c, NAN, STEP, fmi2False));
    REFUSED(fmi2DoStep, (c, 0.0, NAN, fmi2False));
    REFUSED(fmi2DoStep, (c, 0.0, INFINITY, fmi2False));
    REFUSED(fmi2DoStep, (c, -INFINITY, STEP, fmi2False));
    REFUSED(fmi2DoStep, (c, 0.0, -STEP, fmi2False));
    REFUSED(fmi2DoStep, (c, STEP, STEP, fmi2False));
    REFUSED(fmi2DoStep, (c, 0.0, 1e300, fmi2False));
    REFUSED(fmi2DoStep, (c, 0.0, END + STEP, fmi2False));
    REFUSED(fmi2CancelStep, (c));
}

static void statuses(const struct fmu *fmu, fmi2Component c, struct log *log)
{
    fmi2Status status = fmi2OK;
    fmi2Real real = 0.0;
    fmi2Integer integer = 0;
    fmi2Boolean boolean = fmi2True;
    fmi2String string = NULL;
    EXPECT(fmi2Discard, fmi2GetStatus, (c, fmi2DoStepStatus, &status));
    EXPECT(fmi2Discard, fmi2GetRealStatus, (c, fmi2Terminated, &real));
    EXPECT(fmi2Discard, fmi2GetIntegerStatus, (c, fmi2DoStepStatus, &integer));
    EXPECT(fmi2OK, fmi2GetBooleanStatus, (c, fmi2Terminated, &boolean));
    CHECK(boolean == fmi2False, "%d", boolean);
    EXPECT(fmi2Discard, fmi2GetBooleanStatus, (c, (fmi2StatusKind)-1, &boolean));
    EXPECT(fmi2Discard, fmi2GetStringStatus, (c, fmi2PendingStatus, &string));
    EXPECT(fmi2Discard, fmi2GetRealStatus, (c, (fmi2StatusKind)99, &real));
    REFUSED(fmi2GetStatus, (c, fmi2DoStepStatus, NULL));
    REFUSED(fmi2GetRealStatus, (c, fmi2LastSuccessfulTime, NULL));
    REFUSED(fmi2GetIntegerStatus, (c, fmi2DoStepStatus, NULL));
    REFUSED(fmi2GetBooleanStatus, (c, fmi2Terminated, NULL));
    REFUSED(fmi2GetStringStatus, (c, fmi2PendingStatus, NULL));
}

void calls(void)
{
    const struct about *const both[] = {&SET1, &RING12};
    for (size_t i = 0; i < 2; i++) {
        struct fmu loaded, *fmu = &loaded;
        load(fmu, both[i]);
        inquiry(fmu);
        no_instance(fmu);
        instantiation(fmu);
        struct log log = {"the instance that is misused", 0, 0};
        fmi2Component c = start(fmu, &log, push(0));
        logging(fmu, c, &log);
        life(fmu, c, &log);
        variables(fmu, c, &log);
        saved_states(fmu, c, &log);
        derivatives(fmu, c, &log);
        steps(fmu, c, &log);
        statuses(fmu, c, &log);

        /* None of it has left a trace. */
        struct outputs expected, found;
        alone(fmu, push(1), 20, &expected);
        initialize(fmu, c, push(1));
        for (int number = 0; number < 20; number++)
            step(fmu, c, push(1), number);
        read_outputs(fmu, c, &found);
        same(fmu, &expected, &found, "after all misuse");
        fmu->fmi2FreeInstance(c);
        unload(fmu);
    }
    size_t good = 0, bad = 0;
    for (size_t i = 0; i < TALLIES; i++) {
        const char *name = tallies[i].name;
        int cannot_succeed = strcmp(name, "fmi2CancelStep") == 0;
        int cannot_fail = strcmp(name, "fmi2GetVersion") == 0 || strcmp(name, "fmi2GetTypesPlatform") == 0;
        CHECK(tallies[i].good > 0 || cannot_succeed, "%s was never called with good arguments", name);
        CHECK(tallies[i].bad > 0 || cannot_fail, "%s was never called with bad arguments", name);
        good += tallies[i].good;
        bad += tallies[i].bad;
    }
    printf("%d functions: %zu calls with good arguments, %zu with bad ones\n", (int)TALLIES, good, bad);
}
