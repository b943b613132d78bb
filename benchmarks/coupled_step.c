/* The coupled step of a bearing without lead, written by hand in C, as a measure of speed.

   The equations, Newton iterations and energy sums of the default options: exact hysteresis, heat
   from all work, shared hardening, small loops that stay open. Along the displacements of
   benchmarks/scalar_c.py it gives the results of version 0.2.0 within 1.1e-14, and it is frozen: a
   step that grows with new features, or takes fewer operations than this one, is measured against
   the same work in every release. It is no part of the program; benchmarks/scalar_c.py compiles it,
   and a test holds its digest. */
#include <math.h>
#include <string.h>

enum { MOST_LAYERS = 16, MOST_CELLS = 128, PLAIN = 10 };

typedef struct {
    double count, elastic, hysteretic, elastic_exponent, hysteretic_exponent, reference;
    double hardening, yield, curvature, sharing_start, sharing_full, source_rise;
} Rubber;

typedef struct { long first, last, upper, lower; } Place;

typedef struct {
    long layers, cells;
    const double *multiplicity, *to_previous, *to_next, *end_loss, *side_loss, *capacity;
    const Place *places;
} Stack;

typedef struct {
    double d[MOST_LAYERS], z[MOST_LAYERS], temperature[MOST_CELLS];
    double x, force, work, released, ends, sides, heat, mismatch;
} State;

typedef struct {
    double dt, elastic[MOST_LAYERS], hysteretic[MOST_LAYERS], force[MOST_LAYERS];
    double tangent[MOST_LAYERS], trial[MOST_LAYERS], direction[MOST_LAYERS], slope[MOST_LAYERS];
    double elimination[MOST_CELLS], pivot[MOST_CELLS], upper[MOST_CELLS], change[MOST_CELLS];
} Work;

static double law_slope(const Rubber *r, double u) {
    return u >= 0.0 ? 1.0 - (u / r->yield) * (u / r->yield) : 1.0 + r->curvature * u * u;
}

/* Z after a monotone increment in closed form, and dZ/dd. */
static double advance(const Rubber *r, double z, double increment, double *slope) {
    double sigma = increment >= 0.0 ? 1.0 : -1.0, u = sigma * z, e = fabs(increment);
    if (u < 0.0) {
        if (r->curvature == 0.0) {
            double left = e + u;
            u = left >= 0.0 ? 0.0 : u + e;
            e = left >= 0.0 ? left : 0.0;
        } else {
            int turns = r->curvature > 0.0;
            double k = sqrt(fabs(r->curvature)), t = turns ? tan(k * e) : tanh(k * e);
            if (t >= -k * u || (turns && k * e >= 1.5707963267948966)) {
                e -= (turns ? atan(-k * u) : atanh(-k * u)) / k;
                u = 0.0;
            } else {
                u = (u + t / k) / (1.0 - (turns ? 1.0 : -1.0) * k * u * t);
                e = 0.0;
            }
        }
    }
    if (u >= 0.0) {
        double t = tanh(e / r->yield);
        u = (u + r->yield * t) / (1.0 + u * t / r->yield);
    }
    *slope = law_slope(r, u);
    return sigma * u;
}

/* Smallest layer tangent over ke that equal increments would give: how far hardening is shared. */
static double margin(const Rubber *r, double ke, double kh, double d0, double z0, double step) {
    double b = r->hardening, sigma = step >= 0.0 ? 1.0 : -1.0, d = d0 + step, slope;
    if (sigma * d0 >= 0.0 && sigma * z0 >= 0.0) return 1.0;
    if (2.0 * b * fabs(d) * kh * r->yield <= (1.0 - r->sharing_start) * ke) return 1.0;
    double z = advance(r, z0, step, &slope);
    if (d * z >= 0.0) return 1.0;
    slope = 1.0 - (z / r->yield) * (z / r->yield);
    return 1.0 + kh / ke * ((1.0 + b * d * d) * slope + 2.0 * b * d * z);
}

static void layer_force(const Rubber *r, Work *w, long j, double d, double z, double slope,
                        double mean, double share) {
    double s = (1.0 - share) * d + share * mean, h = 1.0 + r->hardening * s * s;
    w->force[j] = w->elastic[j] * d + h * w->hysteretic[j] * z;
    w->tangent[j] = w->elastic[j]
        + w->hysteretic[j] * (h * slope + (1.0 - share) * 2.0 * r->hardening * s * z);
}

static double common_force(const Stack *s, Work *w, double x, double *apart) {
    double compliance = 0.0, gap = x;
    for (long j = 0; j < s->layers; j++) {
        double per = s->multiplicity[j] / w->tangent[j];
        compliance += per;
        gap += per * w->force[j] - s->multiplicity[j] * w->trial[j];
    }
    double force = gap / compliance;
    *apart = 0.0;
    for (long j = 0; j < s->layers; j++) {
        double difference = force - w->force[j];
        *apart = fmax(*apart, fabs(difference));
        w->direction[j] = difference / w->tangent[j];
    }
    return force;
}

/* Equal layer forces at the displacement x; 1 where Newton's method needs a line search. */
static int share(const Rubber *r, const Stack *s, Work *w, const State *old, State *new, double x) {
    double step = (x - old->x) / r->count, mean = x / r->count, least = 1.0, apart;
    for (long j = 0; j < s->layers; j++)
        least = fmin(least, margin(r, w->elastic[j], w->hysteretic[j], old->d[j], old->z[j], step));
    double t = (r->sharing_start - least) / (r->sharing_start - r->sharing_full);
    double weight = t <= 0.0 ? 0.0 : t >= 1.0 ? 1.0 : t * t * (3.0 - 2.0 * t);
    int healthy = weight == 0.0 && fabs(step) < r->yield;
    for (long j = 0; j < s->layers && weight == 0.0; j++) {
        double slope = law_slope(r, step >= 0.0 ? old->z[j] : -old->z[j]);
        layer_force(r, w, j, old->d[j], old->z[j], slope, mean, 0.0);
        w->trial[j] = old->d[j];
        healthy = healthy && w->tangent[j] >= r->sharing_start * w->elastic[j];
    }
    if (healthy) common_force(s, w, x, &apart);
    for (long j = 0; j < s->layers; j++) w->trial[j] = old->d[j] + (healthy ? w->direction[j] : step);
    double floor = (r->elastic + r->hysteretic) * r->yield, force = 0.0;
    for (int iteration = 0;; iteration++) {
        if (iteration > PLAIN) return 1;
        for (long j = 0; j < s->layers; j++) {
            new->z[j] = advance(r, old->z[j], w->trial[j] - old->d[j], &w->slope[j]);
            layer_force(r, w, j, w->trial[j], new->z[j], w->slope[j], mean, weight);
        }
        force = common_force(s, w, x, &apart);
        int kinks = 0;
        for (long j = 0; j < s->layers; j++) {
            double moved = w->trial[j] - old->d[j], by = w->direction[j];
            kinks |= fabs(moved) + (moved >= 0.0 ? by : -by) < 0.0 && fabs(by) > 1e-12 * r->yield;
        }
        if (apart <= 1e-6 * (fabs(force) + floor) && !kinks) break;
        for (long j = 0; j < s->layers; j++) w->trial[j] += w->direction[j];
    }
    new->mismatch = 0.0;
    for (long j = 0; j < s->layers; j++) {
        new->d[j] = w->trial[j] + w->direction[j];
        new->z[j] += w->slope[j] * w->direction[j];
        double h = 1.0 + r->hardening * new->d[j] * new->d[j];
        double law = w->elastic[j] * new->d[j] + h * w->hysteretic[j] * new->z[j];
        new->mismatch = fmax(new->mismatch, fabs(law - force));
    }
    new->x = x;
    new->force = force;
    return 0;
}

static void factor(const Stack *s, Work *w, double dt) {
    double half = 0.5 * dt, upper = 0.0, pivot = 0.0;
    for (long i = 0; i < s->cells; i++) {
        double a = half * s->to_previous[i], c = half * s->to_next[i];
        double loss = half * (s->end_loss[i] + s->side_loss[i]);
        w->elimination[i] = -a * pivot;
        pivot = 1.0 / (1.0 + a + c + loss - w->elimination[i] * upper);
        w->pivot[i] = pivot;
        w->upper[i] = -c * pivot;
        upper = -c;
    }
    w->dt = dt;
}

static void conduct(const Rubber *r, const Stack *s, Work *w, const State *old, State *new,
                    double dt, double ambient) {
    const double *t = old->temperature;
    double mean = 0.5 * (old->force + new->force), last = 0.0;
    double stored = 0.0, ends = 0.0, sides = 0.0;
    if (w->dt != dt) factor(s, w, dt);
    memset(w->change, 0, sizeof(double) * (size_t)s->cells);
    new->released = old->released;
    for (long j = 0; j < s->layers; j++) {
        double heat = mean * (new->d[j] - old->d[j]);
        for (long i = s->places[j].first; i < s->places[j].last; i++) {
            w->change[i] += r->source_rise * heat;
            new->released += s->capacity[i] * r->source_rise * heat;
        }
    }
    for (long i = 0; i < s->cells; i++) {
        double rate = -(s->end_loss[i] + s->side_loss[i]) * (t[i] - ambient);
        if (i > 0) rate += s->to_previous[i] * (t[i - 1] - t[i]);
        if (i < s->cells - 1) rate += s->to_next[i] * (t[i + 1] - t[i]);
        w->change[i] = last = dt * rate + w->change[i] - w->elimination[i] * last;
    }
    last = 0.0;
    for (long i = s->cells - 1; i >= 0; i--) {
        last = w->change[i] * w->pivot[i] - w->upper[i] * last;
        new->temperature[i] = t[i] + last;
        double above = s->capacity[i] * (t[i] - ambient + 0.5 * last);
        stored += s->capacity[i] * last;
        ends += s->end_loss[i] * above;
        sides += s->side_loss[i] * above;
    }
    new->heat = old->heat + stored;
    new->ends = old->ends + dt * ends;
    new->sides = old->sides + dt * sides;
    new->work = old->work + mean * (new->x - old->x);
}

/* March along `count` displacements; returns the steps done. `found` gets the force, the work, the
   heat released, stored, and lost, and then the temperatures of the cells. */
long hdr_march(const Rubber *r, const Stack *s, long count, const double *x, const double *dt,
               const double *ambient, double *found) {
    State one = {0}, two = {0}, *old = &one, *new = &two;
    Work work = {0};
    for (long i = 0; i < s->cells; i++) old->temperature[i] = ambient[0];
    for (long k = 0; k < count; k++) {
        for (long j = 0; j < s->layers; j++) {
            const Place *place = &s->places[j];
            double t = 0.5 * (old->temperature[place->upper] + old->temperature[place->lower]);
            t -= r->reference;
            work.elastic[j] = r->elastic * exp(r->elastic_exponent * t);
            work.hysteretic[j] = r->hysteretic * exp(r->hysteretic_exponent * t);
        }
        if (share(r, s, &work, old, new, x[k])) return k;
        conduct(r, s, &work, old, new, dt[k], ambient[k]);
        State *swap = old;
        old = new;
        new = swap;
    }
    double numbers[] = {old->force, old->work, old->released, old->heat, old->ends + old->sides};
    memcpy(found, numbers, sizeof numbers);
    memcpy(found + 5, old->temperature, sizeof(double) * (size_t)s->cells);
    return count;
}
