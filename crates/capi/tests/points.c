/* Points of light in a host's own OpenCL buffers: what a frame with them must be is what energywave_render gives of a
 * scene that lists the same points; and what does not fit.
 *
 *   points
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "common.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

/* So many are a crowd. */
enum { COUNT = 700, ROWS = 4 * COUNT, TEXT = 1 << 17 };

typedef struct {
    cl_context context;
    cl_command_queue queue;
    cl_mem target;
    energywave_renderer *renderer;
    energywave_scene *scene;
} Host;

/* Numbers that a scene's text and float32 have both whole: 256ths from 0 to 1. */
static float share(unsigned *state) {
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 24) / 256.0f;
}

static void fill(float *positions, float *lights, unsigned seed) {
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) {
            positions[4 * i + k] = 2.0f * share(&seed) - 1.0f;
            lights[4 * i + k] = 0.25f + share(&seed);
        }
        positions[4 * i + 3] = NAN; /* nobody looks there */
        lights[4 * i + 3] = -7.0f;
    }
}

static void add_vectors(char *text, const char *key, const float *rows) {
    size_t at = strlen(text);
    at += (size_t)snprintf(text + at, TEXT - at, "%s = [", key);
    for (int i = 0; i < COUNT; i++) {
        const float *const row = rows + 4 * i;
        at += (size_t)snprintf(text + at, TEXT - at, "[%.8f, %.8f, %.8f],\n", row[0], row[1], row[2]);
    }
    snprintf(text + at, TEXT - at, "]\n");
}

/* Adds a list of points to a scene's text. Without lights they have a colour. */
static void add_points(char *text, const float *positions, const float *lights, const char *profile) {
    const size_t at = strlen(text);
    snprintf(text + at, TEXT - at, "[[points]]\nprofile = \"%s\"\ncoefficient = 0.001953125\n", profile);
    add_vectors(text, "positions", positions);
    if (lights != NULL) {
        add_vectors(text, "colors", lights);
    } else {
        strcat(text, "color = [0.25, 0.5, 1.0]\n");
    }
}

static void render_text(const Host *host, const char *text, float *light) {
    energywave_scene *scene = NULL;
    works(energywave_scene_from_text(text, NULL, &scene), "a scene that lists its points");
    works(energywave_render(host->renderer, scene, light, VALUES * sizeof(float), 0), "its light");
    works(energywave_scene_free(scene), "it is freed");
}

static cl_mem stored(const Host *host, cl_mem_flags flags, size_t bytes, const void *values) {
    cl_int code = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(host->context, flags | (values == NULL ? 0 : CL_MEM_COPY_HOST_PTR), bytes,
                                         (void *)values, &code);
    holds(code == CL_SUCCESS, "the host's buffer");
    return memory;
}

static void draw(const Host *host, const energywave_frame *frame, float *light) {
    cl_event drawn = NULL;
    works(energywave_enqueue(host->renderer, host->scene, frame, &drawn), "a frame with points");
    holds(clEnqueueReadBuffer(host->queue, frame->target, CL_TRUE, 0, VALUES * sizeof(float), light, 1, &drawn, NULL) ==
              CL_SUCCESS,
          "the frame is read");
    clReleaseEvent(drawn);
}

static int is_same(const float *found, const float *expected) {
    return memcmp(found, expected, VALUES * sizeof(float)) == 0;
}

static energywave_points points_of(cl_mem positions, cl_mem lights, const char *profile) {
    return (energywave_points){.struct_size = sizeof(energywave_points),
                               .positions = positions,
                               .lights = lights,
                               .count = COUNT,
                               .coefficient = 0.001953125,
                               .color = {0.25, 0.5, 1.0},
                               .profile = profile};
}

static energywave_frame frame_of(const Host *host, const energywave_points *points, uint32_t count) {
    return (energywave_frame){.struct_size = sizeof(energywave_frame),
                              .target = host->target,
                              .target_kind = ENERGYWAVE_BUFFER,
                              .points = points,
                              .points_count = count};
}

/* Both profiles, with lights and without, one list and two, and others after the host has moved them. */
static void same(const Host *host) {
    static float positions[2][ROWS], lights[2][ROWS], expected[VALUES], found[VALUES], none[VALUES];
    static char text[TEXT];
    fill(positions[0], lights[0], 1);
    fill(positions[1], lights[1], 2);
    const cl_mem places = stored(host, CL_MEM_READ_WRITE, sizeof positions[0], positions[0]);
    const cl_mem colors = stored(host, CL_MEM_READ_ONLY, sizeof lights[0], lights[0]);
    works(energywave_render(host->renderer, host->scene, none, sizeof none, 0), "the scene without points");

    energywave_points both[2] = {points_of(places, colors, NULL), points_of(places, NULL, "inverse")};
    energywave_frame frame = frame_of(host, both, 1);
    snprintf(text, sizeof text, "%s", SMALL);
    add_points(text, positions[0], lights[0], "inverse-square");
    render_text(host, text, expected);
    draw(host, &frame, found);
    holds(is_same(found, expected) && !is_same(found, none), "points with lights are those of a list, to the bit");
    both[0].count--;
    draw(host, &frame, found);
    holds(!is_same(found, expected), "one fewer is another picture");
    both[0].count++;

    add_points(text, positions[0], NULL, "inverse");
    render_text(host, text, expected);
    frame.points_count = 2;
    draw(host, &frame, found);
    holds(is_same(found, expected), "two arrays of points are those of two lists");
    both[1].color[0] = 0.5;
    draw(host, &frame, found);
    holds(!is_same(found, expected), "their colour is looked at");
    both[1].color[0] = 0.25;

    frame.points = both + 1;
    frame.points_count = 1;
    snprintf(text, sizeof text, "%s", SMALL);
    add_points(text, positions[1], NULL, "inverse");
    render_text(host, text, expected);
    draw(host, &frame, found);
    holds(!is_same(found, expected), "other positions give another picture");
    holds(clEnqueueWriteBuffer(host->queue, places, CL_FALSE, 0, sizeof positions[1], positions[1], 0, NULL, NULL) ==
              CL_SUCCESS,
          "the host moves its points");
    draw(host, &frame, found);
    holds(is_same(found, expected), "the frame has them where the host's queue has put them");
    frame.points_count = 0;
    draw(host, &frame, found);
    holds(is_same(found, none), "an array of none adds nothing");
    clReleaseMemObject(places);
    clReleaseMemObject(colors);
}

/* Trails and balls are those of a list, and other pictures than points at rest. */
static void spread(const Host *host) {
    static float positions[ROWS], lights[ROWS], before[ROWS], others[ROWS];
    static float resting[VALUES], expected[VALUES], found[VALUES];
    static char text[TEXT];
    fill(positions, lights, 5);
    fill(before, others, 6);
    const cl_mem places = stored(host, CL_MEM_READ_WRITE, sizeof positions, positions);
    const cl_mem colors = stored(host, CL_MEM_READ_ONLY, sizeof lights, lights);
    const cl_mem earlier = stored(host, CL_MEM_READ_ONLY, sizeof before, before);
    energywave_points points = points_of(places, colors, "inverse");
    const energywave_frame frame = frame_of(host, &points, 1);
    draw(host, &frame, resting);

    points.previous = earlier;
    snprintf(text, sizeof text, "%s", SMALL);
    add_points(text, positions, lights, "inverse");
    add_vectors(text, "previous", before);
    render_text(host, text, expected);
    draw(host, &frame, found);
    holds(is_same(found, expected) && !is_same(found, resting), "trails are those of a list, to the bit");
    points.struct_size = offsetof(energywave_points, previous);
    draw(host, &frame, found);
    holds(is_same(found, resting), "points of an older program have none");
    points.struct_size = sizeof points;

    points.previous = NULL;
    points.profile = "smeared";
    points.radius = 0.03125;
    snprintf(text, sizeof text, "%s", SMALL);
    add_points(text, positions, lights, "smeared");
    strcat(text, "radius = 0.03125\n");
    render_text(host, text, expected);
    draw(host, &frame, found);
    holds(is_same(found, expected) && !is_same(found, resting), "balls are those of a list, to the bit");
    points.radius = 0.0625;
    draw(host, &frame, found);
    holds(!is_same(found, expected), "larger ones are another picture");
    clReleaseMemObject(places);
    clReleaseMemObject(colors);
    clReleaseMemObject(earlier);
}

/* A program that was compiled when frames had no points, one whose points have no trails, and one of a later version
 * whose points have more. */
static void versions(const Host *host) {
    static float positions[ROWS], lights[ROWS], found[VALUES], expected[VALUES];
    struct {
        energywave_points points;
        double more;
    } newer[2];
    fill(positions, lights, 3);
    const cl_mem places = stored(host, CL_MEM_READ_WRITE, sizeof positions, positions);
    const energywave_points points = points_of(places, NULL, NULL);
    energywave_frame frame = frame_of(host, &points, 1);
    draw(host, &frame, expected);
    frame.struct_size = offsetof(energywave_frame, points);
    draw(host, &frame, found);
    holds(!is_same(found, expected), "what lies behind an older struct is not looked at");
    works(energywave_render(host->renderer, host->scene, expected, sizeof expected, 0), "the scene without points");
    holds(is_same(found, expected), "an older program draws as it did");

    energywave_points two[2] = {points, points};
    two[1].coefficient = 0.25;
    frame = frame_of(host, two, 2);
    draw(host, &frame, expected);
    /* Older ones lie closer together; what is behind the last is not theirs. */
    enum { OLDER = offsetof(energywave_points, previous) };
    union {
        energywave_points first;
        char bytes[3 * OLDER];
    } older;
    memset(&older, 0x7f, sizeof older);
    for (int i = 0; i < 2; i++) {
        two[i].struct_size = OLDER;
        memcpy(older.bytes + i * OLDER, &two[i], OLDER);
        two[i].struct_size = sizeof two[i];
    }
    frame.points = &older.first;
    draw(host, &frame, found);
    holds(is_same(found, expected), "shorter points, of an older program, are without trails");
    older.first.struct_size--;
    fails(energywave_enqueue(host->renderer, host->scene, &frame, NULL), ENERGYWAVE_STATUS_BAD_VERSION,
          "which was 72 at the least");
    for (int i = 0; i < 2; i++) {
        newer[i].points = two[i];
        newer[i].points.struct_size = sizeof newer[i];
        newer[i].more = 0.0;
    }
    frame.points = &newer[0].points;
    draw(host, &frame, found);
    holds(is_same(found, expected), "longer points, of a newer program, lie as far apart as they are long");
    newer[1].more = 1.0;
    fails(energywave_enqueue(host->renderer, host->scene, &frame, NULL), ENERGYWAVE_STATUS_BAD_VERSION,
          "frame.points[1]");
    clReleaseMemObject(places);
}

/* What does not fit is refused before anything is enqueued: the target stays as it is. */
static void misfits(const Host *host) {
    static const float before = -7.0f;
    static float positions[ROWS], lights[ROWS], light[VALUES];
    const energywave_status misfit = ENERGYWAVE_STATUS_HOST, argument = ENERGYWAVE_STATUS_BAD_ARGUMENT,
                            version = ENERGYWAVE_STATUS_BAD_VERSION;
    cl_event nothing = NULL;
    fill(positions, lights, 4);
    for (int i = 0; i < VALUES; i++) {
        light[i] = before;
    }
    const cl_mem target = stored(host, CL_MEM_READ_WRITE, sizeof light, light);
    const cl_mem places = stored(host, CL_MEM_READ_WRITE, sizeof positions, positions);
    const cl_mem fewer = stored(host, CL_MEM_READ_WRITE, sizeof positions - 16, positions);
    const cl_mem unread = stored(host, CL_MEM_READ_WRITE | CL_MEM_HOST_NO_ACCESS, sizeof positions, NULL);
    positions[4 * 5 + 1] = NAN;
    lights[4 * 699 + 2] = INFINITY;
    const cl_mem nowhere = stored(host, CL_MEM_READ_WRITE, sizeof positions, positions);
    const cl_mem glaring = stored(host, CL_MEM_READ_WRITE, sizeof lights, lights);
    const cl_image_format format = {CL_RGBA, CL_FLOAT};
    const cl_image_desc shape = {.image_type = CL_MEM_OBJECT_IMAGE2D, .image_width = 32, .image_height = 32};
    cl_int code = CL_SUCCESS;
    const cl_mem image = clCreateImage(host->context, CL_MEM_READ_WRITE, &format, &shape, NULL, &code);
    holds(code == CL_SUCCESS, "the host's image");

    const energywave_points right = points_of(places, NULL, NULL);
    energywave_points two[2] = {right, right};
    energywave_points *const points = two + 1;
    energywave_frame frame = frame_of(host, two, 2);
    frame.target = target;
#define REFUSED(CHANGE, STATUS, WORDS)                                                                                 \
    do {                                                                                                               \
        CHANGE;                                                                                                        \
        fails(energywave_enqueue(host->renderer, host->scene, &frame, &nothing), STATUS, WORDS);                       \
        frame.points = two;                                                                                            \
        two[0] = two[1] = right;                                                                                       \
    } while (0)
    REFUSED(frame.points = NULL, argument, "frame.points: NULL");
    REFUSED(frame.points = (const energywave_points *)((const char *)two + 1), argument, "multiple of 8 bytes");
    REFUSED(two[0].struct_size = 0, version, "frame.points[0]: struct_size 0");
    REFUSED(points->struct_size = 0, version, "frame.points[1]: struct_size 0");
    REFUSED(points->profile = "gaussian", argument, "frame.points[1].profile: \"gaussian\" is none");
    REFUSED(points->profile = "\xff", argument, "frame.points[1].profile: no UTF-8");
    REFUSED(points->positions = NULL, misfit, "positions of points: null");
    REFUSED(points->positions = image, misfit, "positions of points");
    REFUSED(points->positions = nowhere, misfit, "point 5 is at");
    REFUSED(points->positions = unread, misfit, "CL_MEM_HOST_NO_ACCESS");
    REFUSED(points->lights = glaring, misfit, "the light of point 699 is");
    REFUSED((points->previous = nowhere, points->profile = "inverse"), misfit, "point 5 was at");
    REFUSED((points->previous = fewer, points->profile = "inverse"), misfit,
            "previous positions of points: 11184 bytes; 700 points need 16 each");
    REFUSED(points->previous = image, misfit, "previous positions of points");
    REFUSED(points->previous = unread, misfit, "CL_MEM_HOST_NO_ACCESS");
    REFUSED(points->previous = places, ENERGYWAVE_STATUS_SCENE, "points[1].previous");
    REFUSED(points->profile = "smeared", ENERGYWAVE_STATUS_SCENE, "points[1].radius");
    REFUSED(points->radius = (double)NAN, ENERGYWAVE_STATUS_SCENE, "points[1].radius");
    REFUSED(points->count++, misfit, "701 points need 16 each");
    REFUSED(points->count = (size_t)-1, misfit, "need 16 each");
    REFUSED(points->coefficient = (double)NAN, ENERGYWAVE_STATUS_SCENE, "points[1].coefficient");
    REFUSED(points->color[1] = (double)INFINITY, ENERGYWAVE_STATUS_SCENE, "points[1].color");
    energywave_renderer *stale = NULL;
    works(energywave_renderer_on_host(host->context, host->queue, NULL, &stale), "another renderer");
    works(energywave_renderer_free(stale), "it is freed");
    fails(energywave_enqueue(stale, host->scene, &frame, &nothing), ENERGYWAVE_STATUS_BAD_HANDLE, "freed");
    holds(nothing == NULL, "a call that fails gives no event");
    clEnqueueReadBuffer(host->queue, target, CL_TRUE, 0, sizeof light, light, 0, NULL, NULL);
    for (int i = 0; i < VALUES; i++) {
        light[0] = light[i] == before ? light[0] : 0.0f;
    }
    holds(light[0] == before, "what was refused has drawn nothing");
    draw(host, &frame, light);
    holds(light[0] != before, "the next frame is drawn");
    clReleaseMemObject(target);
    clReleaseMemObject(places);
    clReleaseMemObject(fewer);
    clReleaseMemObject(unread);
    clReleaseMemObject(nowhere);
    clReleaseMemObject(glaring);
    clReleaseMemObject(image);
}

int main(void) {
    Host host = {0};
    cl_platform_id platform;
    cl_device_id device;
    cl_int code;
    works(energywave_suit_drivers(), "drivers");
    code = clGetPlatformIDs(1, &platform, NULL);
    code = code != CL_SUCCESS ? code : clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL);
    if (code != CL_SUCCESS) {
        fprintf(stderr, "no OpenCL device: error %d\n", code);
        return 1;
    }
    host.context = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    host.queue = clCreateCommandQueue(host.context, device, 0, &code);
    host.target = stored(&host, CL_MEM_READ_WRITE, VALUES * sizeof(float), NULL);
    works(energywave_scene_from_text(SMALL, NULL, &host.scene), "a scene");
    works(energywave_renderer_on_host(host.context, host.queue, NULL, &host.renderer),
          "a renderer on the host's queue");
    same(&host);
    spread(&host);
    versions(&host);
    misfits(&host);
    works(energywave_renderer_free(host.renderer), "the renderer is freed");
    works(energywave_scene_free(host.scene), "the scene is freed");
    clReleaseMemObject(host.target);
    clReleaseCommandQueue(host.queue);
    clReleaseContext(host.context);
    return finish("points");
}
