/* The forward increment Lagrange scheme on Set 1, as one writes it down from the paper: full
 * matrices, one loop. What benches/step.rs measures Amontons against. */

#include <math.h>
#include <stdint.h>

enum { DOFS = 8, CONTACTS = 2 };
enum { SLIDE = 1, REVERSE_SLIDE = 2, STICK = 3, DETACHED = 4 };

struct problem {
    double mass[DOFS];
    double stiffness[DOFS][DOFS];
    double damping[DOFS][DOFS];
    double force[DOFS];
    double slider_velocity, friction, step;
};

static const int tangent[CONTACTS] = {2, 6};
static const int normal[CONTACTS] = {3, 7};

/* Takes `steps` steps; returns how often a contact changed its state. */
uint64_t dense_loop(const struct problem *restrict problem, double x[restrict DOFS],
                    double v[restrict DOFS], int state[restrict CONTACTS], uint64_t steps)
{
    const struct problem p = *problem;
    const double h = p.step;
    uint64_t changes = 0;
    double inverse_mass[DOFS], a[DOFS];
    for (int i = 0; i < DOFS; i++)
        inverse_mass[i] = 1.0 / p.mass[i];

    for (uint64_t n = 0; n < steps; n++) {
        /* Predictor, eq. (13). */
        for (int i = 0; i < DOFS; i++) {
            double force = p.force[i];
            for (int j = 0; j < DOFS; j++)
                force -= p.damping[i][j] * v[j] + p.stiffness[i][j] * x[j];
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
