/* The integrands of race.py under GSL's plain Monte Carlo and VEGAS.
 *
 * race INTEGRAND DIMS METHOD COUNT RUNS: prints the seconds of all runs, then the estimate of each.
 */
#include <gsl/gsl_monte_plain.h>
#include <gsl/gsl_monte_vegas.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double sum(const double *x, size_t d) {
    double s = 0;
    for (size_t k = 0; k < d; k++) s += x[k];
    return s;
}

static double square(const double *x, size_t d) {
    double s = 0;
    for (size_t k = 0; k < d; k++) s += (x[k] - 0.5) * (x[k] - 0.5);
    return s;
}

static double oscillatory(double *x, size_t d, void *p) { return cos(M_PI + sum(x, d)); }

static double product_peak(double *x, size_t d, void *p) {
    double product = 1;
    for (size_t k = 0; k < d; k++) product *= 0.04 + (x[k] - 0.5) * (x[k] - 0.5);
    return 1 / product;
}

static double corner_peak(double *x, size_t d, void *p) {
    double base = 1 / (1 + sum(x, d)), power = base;
    for (size_t k = 0; k < d; k++) power *= base;
    return power;
}

static double gaussian(double *x, size_t d, void *p) { return exp(-25 * square(x, d)); }

static double continuous(double *x, size_t d, void *p) {
    double s = 0;
    for (size_t k = 0; k < d; k++) s += fabs(x[k] - 0.5);
    return exp(-2 * s);
}

static double discontinuous(double *x, size_t d, void *p) {
    return x[0] < 0.5 && x[1] < 0.5 ? exp(2 * sum(x, d)) : 0;
}

static double peak(double *x, size_t d, void *p) { return exp(-5000 * square(x, d)); }

static const struct {
    const char *name;
    double (*f)(double *, size_t, void *);
} integrands[] = {
    {"oscillatory", oscillatory}, {"product-peak", product_peak}, {"corner-peak", corner_peak},
    {"gaussian", gaussian},       {"continuous", continuous},     {"discontinuous", discontinuous},
    {"peak", peak},
};

int main(int argc, char **argv) {
    if (argc != 6) return 2;
    double (*f)(double *, size_t, void *) = NULL;
    for (size_t k = 0; k < sizeof integrands / sizeof *integrands; k++)
        if (!strcmp(argv[1], integrands[k].name)) f = integrands[k].f;
    size_t dims = strtoul(argv[2], NULL, 10), count = strtoul(argv[4], NULL, 10);
    unsigned long runs = strtoul(argv[5], NULL, 10);
    if (!f || dims > 32 || runs > 1000) return 2;
    double low[32] = {0}, high[32], results[1000], error;
    for (size_t k = 0; k < dims; k++) high[k] = 1;
    gsl_monte_function function = {f, dims, NULL};
    struct timespec begin, end;
    clock_gettime(CLOCK_MONOTONIC, &begin);
    for (unsigned long run = 0; run < runs; run++) {
        gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
        gsl_rng_set(rng, run + 1);
        if (!strcmp(argv[3], "plain")) {
            gsl_monte_plain_state *state = gsl_monte_plain_alloc(dims);
            gsl_monte_plain_integrate(&function, low, high, dims, count, rng, state, &results[run], &error);
            gsl_monte_plain_free(state);
        } else {
            /* A call makes five iterations. A fifth of the evaluations trains the grid, as in GSL's manual. */
            gsl_monte_vegas_state *state = gsl_monte_vegas_alloc(dims);
            gsl_monte_vegas_integrate(&function, low, high, dims, count / 25, rng, state, &results[run], &error);
            gsl_monte_vegas_integrate(&function, low, high, dims, count * 4 / 25, rng, state, &results[run], &error);
            gsl_monte_vegas_free(state);
        }
        gsl_rng_free(rng);
    }
    clock_gettime(CLOCK_MONOTONIC, &end);
    printf("%.9g\n", end.tv_sec - begin.tv_sec + 1e-9 * (end.tv_nsec - begin.tv_nsec));
    for (unsigned long run = 0; run < runs; run++) printf("%.17g\n", results[run]);
    return 0;
}
