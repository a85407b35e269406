/* What the tests in C share: an assertion that counts, and a small scene. */
#ifndef ENERGYWAVE_TESTS_COMMON_H
#define ENERGYWAVE_TESTS_COMMON_H

#include <energywave.h>
#include <stdio.h>
#include <string.h>

static int cases = 0;
static int failures = 0;

/* Checks that something holds. */
static inline void holds(int is_true, const char *what) {
    cases++;
    if (!is_true) {
        failures++;
        fprintf(stderr, "FAILED: %s\n", what);
    }
}

/* What is known of the last failure. */
static inline energywave_error last_error(void) {
    energywave_error error = {.struct_size = sizeof error};
    energywave_last_error(&error);
    return error;
}

/* Checks that a call did its work. */
static inline void works(energywave_status status, const char *what) {
    cases++;
    if (status != ENERGYWAVE_STATUS_OK) {
        failures++;
        fprintf(stderr, "FAILED: %s: %s\n", what, last_error().message);
    }
}

/* Checks that a call failed so, with words that its message has. */
static inline void fails(energywave_status found, energywave_status expected, const char *words) {
    const energywave_error error = last_error();
    const char *const message = error.message;
    cases++;
    if (found != expected || error.status != expected || strstr(message, words) == NULL) {
        failures++;
        fprintf(stderr, "FAILED: expected status %d and \"%s\", found %d: %s\n", (int)expected, words, (int)found,
                message);
    }
}

static inline int finish(const char *name) {
    printf("%s: %d cases, %d failed\n", name, cases, failures);
    return failures != 0;
}

/* 12x8 pixels of a ring and a line. */
static const char *const SMALL = "[camera]\n"
                                 "eye = [0, -4, 2]\n"
                                 "target = [0, 0, 0]\n"
                                 "[image]\n"
                                 "width = 12\n"
                                 "height = 8\n"
                                 "[[torus]]\n"
                                 "color = [0.15, 0.35, 1.0]\n"
                                 "coefficient = 0.05\n"
                                 "radius = 0.1\n"
                                 "major_radius = { times = [0, 2], values = [0.6, 1.2] }\n"
                                 "[[segment]]\n"
                                 "from = [-1, 0, 0]\n"
                                 "to = [1, 0, 0.5]\n"
                                 "radius = 0.1\n"
                                 "coefficient = 0.02\n";

enum { WIDTH = 12, HEIGHT = 8, VALUES = 4 * WIDTH * HEIGHT };

#endif
