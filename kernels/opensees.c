/* A bearing as a uniaxial material of OpenSees: Tcl, xara, and openseespy through Python.

   cc -O2 -shared -fPIC -Wl,-soname,ThermoBearing.so opensees.c -o ThermoBearing.so -ldl

   `uniaxialMaterial ThermoBearing TAG FILE` in Tcl and xara loads ThermoBearing.so, which the
   loader must find, and calls OPS_ThermoBearing. FILE comes from thermobearing.opensees: constants,
   states and workspace of a bearing, the table of its step kernel, and the library with the kernel.

   No header and no code of OpenSees is needed. The library looks up the exported functions of the
   program's ElasticMaterial by name, constructs such a material, and gives it a copy of the table
   of virtual functions with those of a bearing. Whatever is not found as expected is an error. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <link.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "thermobearing.h"

typedef struct {                         /* the start of a file; offsets count from its image */
    char kind[8];
    int64_t size, pointers, call, start, committed, trial, state, library, sources;
    double length, force;                /* mm per length, force per kN of the model */
    double zero, rate, least_dt;         /* mm where the model has zero; mm/s or 0; s */
} Head;

typedef struct Bearing {                 /* follows the program's object in memory */
    struct Bearing *next;
    Head head;
    int64_t *places;                     /* of the pointers in the image */
    char *image;
    void (*step)(tb_step_call *);
    tb_step_call *call;
    double strain, dt, stress, tangent;  /* of the last trial */
    double last_strain, last_stress, last_tangent, first_stress, first_tangent;
    int tag, failed;
} Bearing;

enum { ROOM = 4096 };                    /* for the program's object; it takes about 100 bytes */
#define BEARING(object) ((Bearing *)((char *)(object) + ROOM))

static Bearing *bearings;
static char problem[1024];
static struct {
    void **table;                        /* a copy, from the offset to the top on */
    const double *dt;                    /* step of the domain since the last commit [s] */
    void (*construct)(void *, int, double, double);
    void (*destruct)(void *);
    int (*set_trial)(void *, double, double);
    int (*revert_to_start)(void *);
} program;

static void *fail(const char *text, ...)
{
    va_list given;
    va_start(given, text);
    vsnprintf(problem, sizeof problem, text, given);
    va_end(given);
    return NULL;
}

const char *thermobearing_problem(void) { return problem; }

static void place(Bearing *one, const char *from)
{
    for (int64_t k = 0; k < one->head.pointers; k++)
        *(char **)(one->image + one->places[k]) += one->image - from;
    one->call = (tb_step_call *)(one->image + one->head.call);
}

static void keep_state(Bearing *one, int64_t from, int64_t to)
{
    memcpy(one->image + to, one->image + from, (size_t)one->head.state);
    one->dt = NAN;
    one->failed = 0;
}

/* What the program calls. */

static int apply(Bearing *one, double strain, double dt)
{
    if (strain == one->strain && dt == one->dt)
        return one->failed;
    one->call->x = one->head.zero + (one->strain = strain) * one->head.length;
    one->call->dt = one->dt = dt;
    one->step(one->call);
    one->failed = one->call->result2 > 1 || !isfinite(one->call->result0) ? -1 : 0;
    if (!one->failed) {
        one->stress = one->call->result0 * one->head.force;
        one->tangent = one->call->result1 * one->head.force * one->head.length;
    }
    return one->failed;
}

static int set_trial_strain(void *object, double strain, double rate)
{
    Bearing *one = BEARING(object);
    double dt = *program.dt, moved = fabs(strain - one->last_strain) * one->head.length;
    program.set_trial(object, strain, rate); /* for the strain that it returns itself */
    if (one->head.rate > 0.0 && rate == 0.0)
        dt = moved / one->head.rate;
    else if (dt < 0.0 && moved > 0.0) {
        fprintf(stderr, "ThermoBearing %d: the time goes back while the bearing moves, as in "
                        "displacement control: write the material with a rate [mm/s]\n", one->tag);
        return one->failed = -1;
    }
    return apply(one, strain, fmax(dt, one->head.least_dt));
}

static double get_stress(void *object) { return BEARING(object)->stress; }
static double get_tangent(void *object) { return BEARING(object)->tangent; }
static double get_initial_tangent(void *object) { return BEARING(object)->first_tangent; }

static int set_trial(void *object, double strain, double *stress, double *tangent, double rate)
{
    int failed = set_trial_strain(object, strain, rate);
    *stress = BEARING(object)->stress;
    *tangent = BEARING(object)->tangent;
    return failed;
}

static int commit_state(void *object)
{
    Bearing *one = BEARING(object);
    if (one->failed)
        return -1;
    keep_state(one, one->head.trial, one->head.committed);
    one->last_strain = one->strain;
    one->last_stress = one->stress;
    one->last_tangent = one->tangent;
    return 0;
}

static int revert_to_last_commit(void *object)
{
    Bearing *one = BEARING(object);
    keep_state(one, one->head.committed, one->head.trial);
    one->stress = one->last_stress;
    one->tangent = one->last_tangent;
    return 0;
}

static int revert_to_start(void *object)
{
    Bearing *one = BEARING(object);
    keep_state(one, one->head.start, one->head.committed);
    one->last_strain = 0.0;
    one->last_stress = one->first_stress;
    one->last_tangent = one->first_tangent;
    program.revert_to_start(object);
    return revert_to_last_commit(object);
}

static void destroy(void *object)
{
    Bearing *one = BEARING(object), **link = &bearings;
    while (*link && *link != one)
        link = &(*link)->next;
    if (*link)
        *link = one->next;
    free(one->image);
    free(one->places);
    program.destruct(object);
    free(object);
}

static void *new_object(const Bearing *like, const char *from)
{
    void *object = calloc(1, ROOM + sizeof(Bearing));
    Bearing *one = BEARING(object), **last = &bearings;
    size_t size = (size_t)like->head.size, places = (size_t)like->head.pointers * sizeof(int64_t);
    *one = *like;
    one->next = NULL;
    one->image = memcpy(malloc(size), like->image, size);
    one->places = memcpy(malloc(places), like->places, places);
    place(one, from);
    program.construct(object, one->tag, 0.0, 0.0);
    *(void ***)object = program.table + 2;
    while (*last)
        last = &(*last)->next;
    return *last = one, object;
}

static void *get_copy(void *object) { return new_object(BEARING(object), BEARING(object)->image); }

/* Virtual functions of a bearing, in the order of the program's table. */
#define CLASS "_ZN15ElasticMaterial"
static const struct { const char *name; void *function; } virtual_functions[] = {
    {CLASS "D0Ev", destroy},
    {CLASS "14setTrialStrainEdd", set_trial_strain},
    {CLASS "8setTrialEdRdS0_d", set_trial},
    {CLASS "9getStressEv", get_stress},
    {CLASS "10getTangentEv", get_tangent},
    {CLASS "17getInitialTangentEv", get_initial_tangent},
    {CLASS "11commitStateEv", commit_state},
    {CLASS "18revertToLastCommitEv", revert_to_last_commit},
    {CLASS "13revertToStartEv", revert_to_start},
    {CLASS "7getCopyEv", get_copy},
};

static int find_program(const char *file)
{
    void *code = file ? dlopen(file, RTLD_NOW | RTLD_NOLOAD) : NULL, **table, *function;
    Dl_info about;
    ElfW(Sym) *symbol = NULL;
    size_t slot = 2, k;
    if (program.table)
        return 1;
    if (!code)
        code = dlopen(NULL, RTLD_NOW);
    table = dlsym(code, "_ZTV15ElasticMaterial");
    program.dt = dlsym(code, "ops_Dt");
    program.destruct = dlsym(code, CLASS "D1Ev");
    program.set_trial = dlsym(code, CLASS "14setTrialStrainEdd");
    program.revert_to_start = dlsym(code, CLASS "13revertToStartEv");
    program.construct = dlsym(code, CLASS "C1Eidd");
    if (!program.construct)
        program.construct = dlsym(code, CLASS "C1Eid"); /* of xara; it ignores the last number */
    if (!table || !program.dt || !program.destruct || !program.set_trial ||
        !program.revert_to_start || !program.construct ||
        !dladdr1(table, &about, (void **)&symbol, RTLD_DL_SYMENT) || !symbol)
        return fail("%s does not export ElasticMaterial as OpenSees 3.7 and xara do", file), 0;
    void **copy = malloc(symbol->st_size);
    memcpy(copy, table, symbol->st_size);
    for (k = 0; k < sizeof virtual_functions / sizeof *virtual_functions; k++, slot++) {
        function = dlsym(code, virtual_functions[k].name);
        while (slot < symbol->st_size / sizeof(void *) && copy[slot] != function)
            slot++;
        if (!function || slot >= symbol->st_size / sizeof(void *))
            return free(copy), fail("%s: %s is not in its place among the virtual functions",
                                    file, virtual_functions[k].name), 0;
        copy[slot] = virtual_functions[k].function;
    }
    program.table = copy;
    return 1;
}

static int read_bearing(const char *path, Bearing *one)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return fail("%s cannot be opened", path), 0;
    int fine = fread(&one->head, sizeof one->head, 1, file) == 1 &&
               !memcmp(one->head.kind, "tb-ops-1", 8);
    if (fine) {
        one->places = calloc((size_t)one->head.pointers, sizeof(int64_t));
        one->image = malloc((size_t)one->head.size);
        fine = fread(one->places, sizeof(int64_t), (size_t)one->head.pointers, file) ==
                   (size_t)one->head.pointers &&
               fread(one->image, (size_t)one->head.size, 1, file) == 1;
    }
    fclose(file);
    if (!fine)
        return fail("%s is not a whole file of write_material()", path), 0;
    const char *name = one->image + one->head.library, *sources;
    dlopen("libm.so.6", RTLD_NOW | RTLD_GLOBAL); /* for exp and the like */
    void *code = dlopen(name, RTLD_NOW);
    if (!code)
        return fail("%s: %s", path, dlerror()), 0;
    one->step = (void (*)(tb_step_call *))dlsym(code, "thermobearing_step");
    sources = dlsym(code, "thermobearing_sources");
    if (!one->step || !sources || strcmp(sources, one->image + one->head.sources))
        return fail("%s was written for other kernels than those of %s", path, name), 0;
    return 1;
}

static void *new_material(const char *file, int tag, const char *path)
{
    Bearing one = {.tag = tag, .dt = NAN};
    void *object = NULL;
    if (find_program(file) && read_bearing(path, &one)) {
        object = new_object(&one, NULL);
        apply(BEARING(object), 0.0, one.head.least_dt);
        BEARING(object)->first_stress = BEARING(object)->stress;
        BEARING(object)->first_tangent = BEARING(object)->tangent;
        revert_to_start(object);
    }
    free(one.image);
    free(one.places);
    return object;
}

/* For Python: 0, or -1 with a sentence in thermobearing_problem(). */
int thermobearing_add(const char *file, int tag, const char *path)
{
    void *code = dlopen(file, RTLD_NOW | RTLD_NOLOAD);
    char (*add)(void *) = code ? dlsym(code, "_Z23OPS_addUniaxialMaterialP16UniaxialMaterial") : NULL;
    void *material = add ? new_material(file, tag, path) : NULL;
    if (!add)
        fail("%s exports no function that adds a material", file);
    if (material && add(material))
        return 0;
    if (material) {
        destroy(material);
        fail("tag %d is used by another material", tag);
    }
    return -1;
}

/* The image of the k-th bearing of a tag, materials before the copies in elements; or none. */
const char *thermobearing_image(int tag, int k)
{
    Bearing *one = bearings;
    while (one && (one->tag != tag || k--))
        one = one->next;
    return one ? one->image : NULL;
}

/* For `uniaxialMaterial ThermoBearing TAG FILE`. */
void *OPS_ThermoBearing(void)
{
    Dl_info about = {0};
    dladdr(__builtin_return_address(0), &about);
    void *code = about.dli_fname ? dlopen(about.dli_fname, RTLD_NOW | RTLD_NOLOAD) : NULL;
    if (!code)
        code = dlopen(NULL, RTLD_NOW);
    int (*get_int)(int *, int *) = dlsym(code, "ops_getintinput_");
    const char *(*get_string)(void) = dlsym(code, "ops_getstring");
    int one = 1, tag = 0;
    void *material = NULL;
    if (!get_int || !get_string)
        fail("%s does not export how it reads arguments", about.dli_fname);
    else if (get_int(&one, &tag))
        fail("uniaxialMaterial ThermoBearing needs a tag and a file");
    else
        material = new_material(about.dli_fname, tag, get_string());
    if (!material)
        fprintf(stderr, "uniaxialMaterial ThermoBearing: %s\n", problem);
    return material;
}
