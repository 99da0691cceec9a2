/* Runs a co-simulation FMU's Windows library and prints the bits of what it reads:

   host.exe LIBRARY GUID RESOURCES INTERVAL ROWS [=REFERENCE:VALUE ...] [rREFERENCE|iREFERENCE ...]

   An empty RESOURCES is NULL. After the start, and after each interval, a line with the bits of the doubles and the
   whole numbers. */
#include "fmi2FunctionTypes.h"
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <windows.h>

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    va_list rest;
    (void)environment;
    va_start(rest, message);
    fprintf(stderr, "%s: %d %s: ", name, status, category);
    vfprintf(stderr, message, rest);
    fputc('\n', stderr);
    va_end(rest);
}

static HMODULE library;

static void (*function(const char *name))(void)
{
    void (*found)(void) = (void (*)(void))GetProcAddress(library, name);
    if (!found) {
        fprintf(stderr, "%s is missing\n", name);
        exit(1);
    }
    return found;
}

#define CALL(name, ...) (((fmi2##name##TYPE *)function("fmi2" #name))(__VA_ARGS__))

static void check(fmi2Status status, const char *what)
{
    if (status != fmi2OK) {
        fprintf(stderr, "%s: status %d\n", what, status);
        exit(1);
    }
}

static void print(fmi2Component one, int count, char **names)
{
    for (int i = 0; i < count; i++) {
        fmi2ValueReference reference = strtoul(names[i] + 1, NULL, 10);
        if (names[i][0] == 'r') {
            fmi2Real value;
            unsigned long long bits;
            check(CALL(GetReal, one, &reference, 1, &value), names[i]);
            memcpy(&bits, &value, sizeof bits);
            printf("%016llx ", bits);
        } else {
            fmi2Integer value;
            check(CALL(GetInteger, one, &reference, 1, &value), names[i]);
            printf("%d ", value);
        }
    }
    printf("\n");
}

int main(int count, char **arguments)
{
    static const fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    if (count < 6)
        return 2;
    library = LoadLibraryA(arguments[1]);
    if (!library) {
        fprintf(stderr, "%s: error %lu\n", arguments[1], GetLastError());
        return 1;
    }
    const char *resources = arguments[3][0] ? arguments[3] : NULL;
    double interval = strtod(arguments[4], NULL);
    int rows = atoi(arguments[5]), next = 6;
    fmi2Component one = CALL(Instantiate, "one", fmi2CoSimulation, arguments[2], resources, &callbacks, 0, 0);
    if (!one)
        return 3;
    check(CALL(SetupExperiment, one, 0, 0.0, 0.0, 0, 0.0), "SetupExperiment");
    for (; next < count && arguments[next][0] == '='; next++) {
        char *end;
        fmi2ValueReference reference = strtoul(arguments[next] + 1, &end, 10);
        fmi2Real value = strtod(end + 1, NULL);
        check(CALL(SetReal, one, &reference, 1, &value), arguments[next]);
    }
    check(CALL(EnterInitializationMode, one), "EnterInitializationMode");
    check(CALL(ExitInitializationMode, one), "ExitInitializationMode");
    print(one, count - next, arguments + next);
    for (int row = 0; row < rows; row++) {
        double time = row * interval;
        check(CALL(DoStep, one, time, (row + 1) * interval - time, 1), "DoStep");
        print(one, count - next, arguments + next);
    }
    CALL(FreeInstance, one);
    return 0;
}
