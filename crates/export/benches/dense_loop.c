/* The forward increment Lagrange scheme on Set 1 as plain loops with full matrices, which
 * benches/step.rs measures Amontons against: dense_loop as one writes it down from the paper, and
 * effective_loop, which multiplies K once, by x + beta v, since C = beta K. */

#include <math.h>
#include <stdint.h>

enum { DOFS = 8, CONTACTS = 2 };
enum { SLIDE = 1, REVERSE_SLIDE = 2, STICK = 3, DETACHED = 4 };

struct problem {
    double mass[DOFS];
    double stiffness[DOFS][DOFS];
    double damping[DOFS][DOFS];
    double force[DOFS];
    double slider_velocity, friction, step, beta;
};

static const int tangent[CONTACTS] = {2, 6};
static const int normal[CONTACTS] = {3, 7};

/* Takes `steps` steps; returns how often a contact changed its state. */
static inline __attribute__((always_inline)) uint64_t
loop(const struct problem *restrict problem, double x[restrict DOFS], double v[restrict DOFS],
     int state[restrict CONTACTS], uint64_t steps, int effective)
{
    const struct problem p = *problem;
    const double h = p.step;
    uint64_t changes = 0;
    double inverse_mass[DOFS], a[DOFS], w[DOFS];
    for (int i = 0; i < DOFS; i++)
        inverse_mass[i] = 1.0 / p.mass[i];

    for (uint64_t n = 0; n < steps; n++) {
        /* Predictor, eq. (13). */
        if (effective)
            for (int j = 0; j < DOFS; j++)
                w[j] = x[j] + p.beta * v[j];
        for (int i = 0; i < DOFS; i++) {
            double force = p.force[i];
            for (int j = 0; j < DOFS; j++)
                force -= effective ? p.stiffness[i][j] * w[j]
                                   : p.damping[i][j] * v[j] + p.stiffness[i][j] * x[j];
            a[i] = inverse_mass[i] * force;
        }
        for (int i = 0; i < DOFS; i++)
            v[i] += h * a[i];

        for (int c = 0; c < CONTACTS; c++) {
            const int N = normal[c], T = tangent[c];
            int now = DETACHED;
            const double gap = x[N] + h * v[N];
            if (gap <= 0.0) {
                /* Multipliers, eq. (16): normal, then tangential up to Coulomb's limit. */
                const double pressure = -gap * p.mass[N] / (h * h);
                const double limit = p.friction * pressure;
                double drag = (p.slider_velocity - v[T]) * p.mass[T] / h;
                now = STICK;
                if (drag > limit) {
                    drag = limit;
                    now = SLIDE;
                } else if (drag < -limit) {
                    drag = -limit;
                    now = REVERSE_SLIDE;
                }
                /* Corrector, eqs. (17), (18). */
                v[N] += h * inverse_mass[N] * pressure;
                v[T] += h * inverse_mass[T] * drag;
            }
            if (now != state[c]) {
                state[c] = now;
                changes++;
            }
        }
        for (int i = 0; i < DOFS; i++)
            x[i] += h * v[i];
    }
    return changes;
}

uint64_t dense_loop(const struct problem *restrict problem, double x[restrict DOFS],
                    double v[restrict DOFS], int state[restrict CONTACTS], uint64_t steps)
{
    return loop(problem, x, v, state, steps, 0);
}

uint64_t effective_loop(const struct problem *restrict problem, double x[restrict DOFS],
                        double v[restrict DOFS], int state[restrict CONTACTS], uint64_t steps)
{
    return loop(problem, x, v, state, steps, 1);
}
