/* The paper's scheme in plain C: full matrices, Gauss-Seidel over the contacts from the forces of the step before, until no force
 * changes by more than 1e-13 of the largest one. Reads the model from a file, prints the seconds of its steps and the velocities. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double *numbers(FILE *file, size_t count) {
    double *values = malloc(count * sizeof *values);
    if (values == NULL || fread(values, sizeof *values, count, file) != count) exit(2);
    return values;
}

/* y = A x, A by rows. */
static void multiply(const double *restrict a, const double *restrict x, double *restrict y, int rows, int columns) {
    for (int i = 0; i < rows; i++) {
        double sum = 0;
        for (int j = 0; j < columns; j++) sum += a[(size_t)i * columns + j] * x[j];
        y[i] = sum;
    }
}

int main(int count, char **arguments) {
    if (count != 2) return 2;
    FILE *file = fopen(arguments[1], "rb");
    if (file == NULL) return 2;
    double *head = numbers(file, 6);
    int n = (int)head[0], m = (int)head[1], steps = (int)head[2];
    double h = head[3], mu = head[4], surface = head[5];
    /* K, C, M^-1; G and M^-1 G' (normal and tangent of each contact in turn); W; F, x, v. */
    double *k = numbers(file, (size_t)n * n), *c = numbers(file, (size_t)n * n), *inverse = numbers(file, (size_t)n * n);
    double *g = numbers(file, (size_t)2 * m * n), *response = numbers(file, (size_t)n * 2 * m);
    double *w = numbers(file, (size_t)4 * m * m), *f = numbers(file, n), *x = numbers(file, n), *v = numbers(file, n);
    double *force = calloc(n, sizeof *force), *damped = calloc(n, sizeof *damped), *a = calloc(n, sizeof *a);
    double *along = calloc(2 * m, sizeof *along), *gap = calloc(2 * m, sizeof *gap), *drift = calloc(2 * m, sizeof *drift);
    double *lambda = calloc(2 * m, sizeof *lambda), *pushed = calloc(n, sizeof *pushed);
    char *closed = calloc(m, 1);
    for (int i = 0; i < m; i++) closed[i] = 1;
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    long sweeps = 0;
    for (int step = 0; step < steps; step++) {
        multiply(k, x, force, n, n);
        multiply(c, v, damped, n, n);
        for (int i = 0; i < n; i++) force[i] = f[i] - force[i] - damped[i];
        multiply(inverse, force, a, n, n);
        multiply(g, x, gap, 2 * m, n);
        multiply(g, v, along, 2 * m, n);
        multiply(g, a, drift, 2 * m, n);
        for (int i = 0; i < m; i++) {
            double open = closed[i] || gap[2 * i] < 0 ? 0 : gap[2 * i];
            drift[2 * i] += (along[2 * i] + open / h) / h;
            drift[2 * i + 1] += (along[2 * i + 1] - surface) / h;
        }
        for (int sweep = 0; sweep < 10000; sweep++) {
            double change = 0, largest = 1e-300;
            sweeps++;
            for (int i = 0; i < m; i++) {
                double an = drift[2 * i], at = drift[2 * i + 1];
                const double *rn = w + (size_t)2 * i * 2 * m, *rt = rn + 2 * m;
                for (int j = 0; j < 2 * m; j++) {
                    an += rn[j] * lambda[j];
                    at += rt[j] * lambda[j];
                }
                double nn = rn[2 * i], nt = rn[2 * i + 1], tt = rt[2 * i + 1];
                double old_n = lambda[2 * i], old_t = lambda[2 * i + 1];
                an -= nn * old_n + nt * old_t;
                at -= nt * old_n + tt * old_t;
                double normal = 0, friction = 0;
                if (an < 0) {
                    double d = nn * tt - nt * nt;
                    normal = (nt * at - tt * an) / d;
                    friction = (nt * an - nn * at) / d;
                    if (fabs(friction) > mu * normal || normal < 0) {
                        double sign = friction > 0 ? 1 : -1;
                        normal = -an / (nn + sign * mu * nt);
                        friction = sign * mu * normal;
                    }
                }
                change = fmax(change, fmax(fabs(normal - old_n), fabs(friction - old_t)));
                largest = fmax(largest, fmax(normal, fabs(friction)));
                lambda[2 * i] = normal;
                lambda[2 * i + 1] = friction;
            }
            if (change <= 1e-13 * largest) break;
        }
        multiply(response, lambda, pushed, n, 2 * m);
        for (int i = 0; i < n; i++) {
            v[i] += h * (a[i] + pushed[i]);
            x[i] += h * v[i];
        }
        for (int i = 0; i < m; i++) closed[i] = lambda[2 * i] > 0;
    }
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    printf("%.9g %ld\n", (end.tv_sec - start.tv_sec) + 1e-9 * (end.tv_nsec - start.tv_nsec), sweeps);
    for (int i = 0; i < n; i++) printf("%.17g\n", v[i]);
    return 0;
}
