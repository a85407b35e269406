/* What calls give where they work: light beside the float64 reference, rays beside a closed form, strides, pictures,
 * times, and one scene and one renderer that several threads use.
 *
 *   works FOLDER [DEVICE]   (reference where none is given)
 */
#include "common.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

static const char *device = "reference";

/* What the tolerance of a scene, 1e-3, lets a pixel miss. */
static const double TOLERANCE = 1e-3;

/* The greatest difference of two lights, relative to the pixel. */
static double worst(const float *found, const float *expected, size_t count) {
    double most = 0.0;
    for (size_t i = 0; i < count; i++) {
        const double miss = fabs((double)found[i] - expected[i]) / fmax(fabs(expected[i]), 1e-6);
        most = miss > most ? miss : most;
    }
    return most;
}

static void light(energywave_renderer *renderer, energywave_scene *scene) {
    static float found[VALUES], truth[VALUES], later[VALUES];
    works(energywave_render(renderer, scene, found, sizeof found, 0), "render");
    works(energywave_reference(scene, truth, sizeof truth, 0), "reference");
    const double miss = worst(found, truth, VALUES);
    printf("  the worst pixel misses the reference by %.2e\n", miss);
    holds(miss < 10.0 * TOLERANCE, "light is that of the reference");
    found[VALUES / 2] *= 1.05f;
    holds(worst(found, truth, VALUES) > 10.0 * TOLERANCE, "a spoiled pixel is found");
    works(energywave_scene_set_time(scene, 2.0), "another time");
    works(energywave_reference(scene, later, sizeof later, 0), "reference at 2 s");
    holds(worst(later, truth, VALUES) > 0.1, "the ring has grown");
    works(energywave_scene_set_time(scene, 0.0), "back");
}

/* Rows that are further apart than they are long: what lies between stays. */
static void strides(energywave_renderer *renderer, energywave_scene *scene) {
    enum { STRIDE = 4 * WIDTH + 5 };
    static float tight[VALUES], wide[HEIGHT * STRIDE];
    static unsigned char rgb[3 * WIDTH * HEIGHT], rgba[HEIGHT][4 * WIDTH + 3];
    const size_t needed = ((HEIGHT - 1) * STRIDE + 4 * WIDTH) * sizeof(float);
    int is_same = 1, is_kept = 1;
    for (size_t i = 0; i < HEIGHT * STRIDE; i++) {
        wide[i] = -7.0f;
    }
    memset(rgba, 9, sizeof rgba);
    works(energywave_render(renderer, scene, tight, sizeof tight, 0), "rows without gaps");
    works(energywave_render(renderer, scene, wide, needed, STRIDE * sizeof(float)), "rows with gaps");
    for (int row = 0; row < HEIGHT; row++) {
        const float *const begin = wide + row * STRIDE;
        is_same &= memcmp(begin, tight + 4 * row * WIDTH, 4 * WIDTH * sizeof(float)) == 0;
        for (int gap = 4 * WIDTH; gap < STRIDE; gap++) {
            is_kept &= begin[gap] == -7.0f;
        }
    }
    holds(is_same, "the same light with gaps, to the bit");
    holds(is_kept, "what lies between rows stays");
    works(energywave_tone_map(scene, tight, sizeof tight, 0, 0, rgb, sizeof rgb, 0, 3), "three channels");
    works(energywave_tone_map(scene, wide, needed, STRIDE * sizeof(float), 0, rgba[0], sizeof rgba, sizeof rgba[0], 4),
          "four channels with gaps");
    is_same = is_kept = 1;
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            is_same &= memcmp(rgba[row] + 4 * column, rgb + 3 * (row * WIDTH + column), 3) == 0;
            is_same &= rgba[row][4 * column + 3] == 255;
        }
        is_kept &= rgba[row][4 * WIDTH] == 9 && rgba[row][4 * WIDTH + 2] == 9;
    }
    holds(is_same, "the same picture, opaque");
    holds(is_kept, "what lies between rows of a picture stays");
    int is_black = 1;
    for (size_t i = 0; i < sizeof rgb; i++) {
        is_black &= rgb[i] == 0;
    }
    holds(!is_black, "the picture has light");
}

/* A point's light along a line at the distance d, 1/r^2, over the length 2a: 2/d atan(a/d). */
static void rays(energywave_renderer *renderer) {
    static const char *const POINT = "{\"camera\": {\"eye\": [0, -4, 2], \"target\": [0, 0, 0]}, \"integration\": "
                                     "{\"tolerance\": 1e-5}, \"sphere\": [{\"color\": [1, 0.5, 0.25]}]}";
    enum { COUNT = 8 };
    energywave_scene *scene = NULL;
    double origins[3 * COUNT], ends[3 * COUNT], rgb[3 * COUNT], most = 0.0;
    works(energywave_scene_from_text(POINT, NULL, &scene), "a point in JSON");
    for (int i = 0; i < COUNT; i++) {
        const double distance = 0.25 * (i + 1);
        const double origin[3] = {-3.0, distance, 0.0}, end[3] = {3.0, distance, 0.0};
        memcpy(origins + 3 * i, origin, sizeof origin);
        memcpy(ends + 3 * i, end, sizeof end);
    }
    works(energywave_integrate(renderer, scene, origins, ends, COUNT, rgb), "rays");
    for (int i = 0; i < COUNT; i++) {
        const double distance = 0.25 * (i + 1);
        const double exact = 2.0 / distance * atan(3.0 / distance);
        for (int channel = 0; channel < 3; channel++) {
            const double expected = exact * (channel == 0 ? 1.0 : channel == 1 ? 0.5 : 0.25);
            most = fmax(most, fabs(rgb[3 * i + channel] - expected) / expected);
        }
    }
    printf("  the worst ray misses its closed form by %.2e\n", most);
    holds(most < 2e-5, "rays are their closed form");
    works(energywave_integrate(renderer, scene, NULL, NULL, 0, NULL), "no rays need no memory");
    works(energywave_scene_free(scene), "the point is freed");
}

static void texts(energywave_scene *scene, const char *folder) {
    energywave_scene_info info = {.struct_size = sizeof info};
    energywave_overrides larger = {.struct_size = sizeof larger, .width = 30, .height = 20, .tolerance = 1e-4};
    energywave_device known = {.struct_size = sizeof known};
    static float found[VALUES];
    char *text = NULL, path[4096];
    works(energywave_devices(&text), "devices");
    holds(text != NULL && strstr(text, "\"name\":\"reference\"") != NULL, "the reference is a device");
    works(energywave_text_free(text), "the text is freed");
    works(energywave_device_describe("reference", &known), "a device");
    holds(strcmp(known.name, "reference") == 0 && strcmp(known.device_type, "reference") == 0, "its name and type");
    works(energywave_scene_override(scene, &larger), "another size");
    works(energywave_scene_describe(scene, &info), "the scene");
    holds(info.width == 30 && info.height == 20 && info.is_animated == 1 && info.sources == 2, "what it is");
    works(energywave_scene_override(scene, NULL), "its own size");
    works(energywave_scene_describe(scene, &info), "the scene");
    holds(info.width == WIDTH && info.height == HEIGHT, "the size of its text");
    works(energywave_scene_warnings(scene, &text), "warnings");
    works(energywave_text_free(text), "they are freed");
    works(energywave_reference(scene, found, sizeof found, 0), "light for a file");
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/works.%s", folder, i == 0 ? "png" : "exr");
        works(energywave_save(scene, found, sizeof found, 0, 0, path), "a file");
    }
    holds(strcmp(energywave_version(), EXPECTED_VERSION) == 0, "the version is that of pkg-config");
}

typedef struct {
    energywave_renderer *renderer;
    energywave_scene *scene;
    const float *expected;
    int wrong;
} Work;

/* Draws with what other threads draw with; and fails, of which the others know nothing. */
static void *work(void *given) {
    Work *const mine = given;
    float found[VALUES];
    for (int i = 0; i < 4; i++) {
        const energywave_status drawn = energywave_render(mine->renderer, mine->scene, found, sizeof found, 0);
        mine->wrong += drawn != ENERGYWAVE_STATUS_OK || memcmp(found, mine->expected, sizeof found) != 0;
        mine->wrong += last_error().status != (i == 0 ? ENERGYWAVE_STATUS_OK : ENERGYWAVE_STATUS_BAD_ARGUMENT);
        energywave_render(mine->renderer, mine->scene, NULL, 0, 0);
    }
    return NULL;
}

static void threads(energywave_renderer *renderer, energywave_scene *scene) {
    enum { COUNT = 4 };
    static float expected[VALUES];
    pthread_t ids[COUNT];
    Work works_of[COUNT];
    int wrong = 0;
    works(energywave_render(renderer, scene, expected, sizeof expected, 0), "render");
    for (int i = 0; i < COUNT; i++) {
        works_of[i] = (Work){renderer, scene, expected, 0};
        wrong += pthread_create(&ids[i], NULL, work, &works_of[i]) != 0;
    }
    for (int i = 0; i < COUNT; i++) {
        pthread_join(ids[i], NULL);
        wrong += works_of[i].wrong;
    }
    holds(wrong == 0, "threads share a renderer, and each has its own last error");
}

int main(int argc, char **argv) {
    energywave_scene *scene = NULL;
    energywave_renderer *renderer = NULL;
    energywave_cost cost = {.struct_size = sizeof cost};
    const char *const folder = argc > 1 ? argv[1] : ".";
    device = argc > 2 ? argv[2] : device;
    works(energywave_check_abi(ENERGYWAVE_ABI), "the versions fit");
    works(energywave_suit_drivers(), "drivers");
    works(energywave_scene_from_text(SMALL, NULL, &scene), "a scene");
    works(energywave_renderer_new(device, NULL, &renderer), "a renderer");
    light(renderer, scene);
    strides(renderer, scene);
    rays(renderer);
    texts(scene, folder);
    threads(renderer, scene);
    works(energywave_renderer_cost(renderer, &cost), "cost");
    holds(cost.integrals > 0, "a frame has integrals");
    works(energywave_renderer_free(renderer), "the renderer is freed");
    works(energywave_scene_free(scene), "the scene is freed");
    return finish("works");
}
