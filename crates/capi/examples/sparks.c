/* A particle system that lives on the device: a kernel of the host's turns a million sparks about a core, in the host's
 * own buffers, and they are drawn from there as a crowd. Writes three frames, PREFIX-0.png to PREFIX-2.png.
 *
 *   cc sparks.c $(pkg-config --cflags --libs energywave) -lOpenCL -o sparks
 *   ./sparks PREFIX [NUMBER OF SPARKS]
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <energywave.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WIDTH = 960, HEIGHT = 540, FRAMES = 3 };

/* A pixel has many sparks: what a single ray sees of them is as good as a mean over the pixel, and sooner there. All
 * that light together is a veil: dark enough, only the arms and the core are left. */
static const char *const SCENE = "[camera]\n"
                                 "eye = [0, -4.5, 2.6]\n"
                                 "target = [0, 0, 0]\n"
                                 "[image]\n"
                                 "width = 960\n"
                                 "height = 540\n"
                                 "[integration]\n"
                                 "antialias = \"none\"\n"
                                 "[display]\n"
                                 "exposure = -4.6\n"
                                 "tone_map = \"aces\"\n";

/* Where a spark is, and its light; multiples of irrational numbers lie evenly. */
static const char *const TURN =
    "float share(uint number, uint step) { return (float)(number * step) / 4294967296.0f; }\n"
    "kernel void turn(global float4 *places, global float4 *lights, uint count, float time) {\n"
    "    const uint number = get_global_id(0);\n"
    "    const float radius = 2.2f * ((float)number + 0.5f) / (float)count;\n"
    "    const float arm = 3.1415927f * (float)(number % 2) + 2.0f * radius;\n"
    "    const float aside = 1.6f * (share(number, 2654435769u) - 0.5f) / (0.3f + radius);\n"
    "    const float angle = arm + aside + time / (0.2f + radius);\n"
    "    const float height = 0.15f * (share(number, 1779033704u) - 0.5f) * (1.0f - 0.3f * radius);\n"
    "    const float heat = 1.0f / (1.0f + 3.0f * radius * radius);\n"
    "    places[number] = (float4)(radius * cos(angle), radius * sin(angle), height, 0.0f);\n"
    "    lights[number] = (float4)(0.25f + heat, 0.35f + 0.6f * heat, 1.0f, 0.0f);\n"
    "}\n";

static int failed(energywave_status status) {
    energywave_error error = {.struct_size = sizeof error};
    if (status == ENERGYWAVE_STATUS_OK) {
        return 0;
    }
    energywave_last_error(&error);
    fprintf(stderr, "error (%s): %s\n", error.code, error.message);
    return 1;
}

static int refused(cl_int code, const char *what) {
    if (code != CL_SUCCESS) {
        fprintf(stderr, "%s: error %d\n", what, code);
    }
    return code != CL_SUCCESS;
}

/* What the host has. */
typedef struct {
    cl_context context;
    cl_command_queue queue;
    cl_program program;
    cl_kernel turn;
    cl_mem places, lights, target;
    cl_uint count;
} Host;

static int open_host(Host *host) {
    cl_platform_id platform;
    cl_device_id device;
    cl_int code = clGetPlatformIDs(1, &platform, NULL);
    if (code == CL_SUCCESS) {
        code = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, NULL);
    }
    if (code == CL_SUCCESS) {
        host->context = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    }
    if (code == CL_SUCCESS) {
        host->queue = clCreateCommandQueue(host->context, device, 0, &code);
    }
    cl_mem *const buffers[] = {&host->places, &host->lights, &host->target};
    for (int i = 0; i < 3 && code == CL_SUCCESS; i++) {
        const size_t rows = i < 2 ? host->count : WIDTH * HEIGHT;
        *buffers[i] = clCreateBuffer(host->context, CL_MEM_READ_WRITE, rows * sizeof(cl_float4), NULL, &code);
    }
    if (code == CL_SUCCESS) {
        host->program = clCreateProgramWithSource(host->context, 1, (const char **)&TURN, NULL, &code);
    }
    if (code == CL_SUCCESS) {
        code = clBuildProgram(host->program, 1, &device, "", NULL, NULL);
    }
    if (code == CL_SUCCESS) {
        host->turn = clCreateKernel(host->program, "turn", &code);
    }
    if (code == CL_SUCCESS) {
        clSetKernelArg(host->turn, 0, sizeof host->places, &host->places);
        clSetKernelArg(host->turn, 1, sizeof host->lights, &host->lights);
        code = clSetKernelArg(host->turn, 2, sizeof host->count, &host->count);
    }
    return refused(code, "the host's OpenCL");
}

static void close_host(const Host *host) {
    const cl_mem buffers[] = {host->places, host->lights, host->target};
    for (int i = 0; i < 3; i++) {
        if (buffers[i] != NULL) {
            clReleaseMemObject(buffers[i]);
        }
    }
    if (host->turn != NULL) {
        clReleaseKernel(host->turn);
    }
    if (host->program != NULL) {
        clReleaseProgram(host->program);
    }
    if (host->queue != NULL) {
        clReleaseCommandQueue(host->queue);
    }
    if (host->context != NULL) {
        clReleaseContext(host->context);
    }
}

static double seconds(void) {
    struct timespec now;
    timespec_get(&now, TIME_UTC);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Moves the sparks and draws them: the frame reads them after the kernel, which is on the host's queue before it. */
static int draw(const Host *host, energywave_renderer *renderer, energywave_scene *scene, float *light, float time) {
    const energywave_points sparks = {.struct_size = sizeof sparks,
                                      .positions = host->places,
                                      .lights = host->lights,
                                      .count = host->count,
                                      .coefficient = 1.0 / host->count};
    const energywave_frame frame = {.struct_size = sizeof frame,
                                    .target = host->target,
                                    .target_kind = ENERGYWAVE_BUFFER,
                                    .points = &sparks,
                                    .points_count = 1};
    const size_t items = host->count;
    const double begun = seconds();
    cl_int code = clSetKernelArg(host->turn, 3, sizeof time, &time);
    if (code == CL_SUCCESS) {
        code = clEnqueueNDRangeKernel(host->queue, host->turn, 1, NULL, &items, NULL, 0, NULL, NULL);
    }
    if (refused(code, "the host's kernel") || failed(energywave_enqueue(renderer, scene, &frame, NULL))) {
        return 1;
    }
    const size_t bytes = 4 * WIDTH * HEIGHT * sizeof(float);
    code = clEnqueueReadBuffer(host->queue, host->target, CL_TRUE, 0, bytes, light, 0, NULL, NULL);
    printf("%u sparks moved and drawn in %.0f ms\n", host->count, 1e3 * (seconds() - begun));
    return refused(code, "reading the frame");
}

int main(int argc, char **argv) {
    static float light[4 * WIDTH * HEIGHT];
    Host host = {.count = argc > 2 ? (cl_uint)strtoul(argv[2], NULL, 10) : 1000000};
    energywave_scene *scene = NULL;
    energywave_renderer *renderer = NULL;
    if (argc < 2 || host.count == 0) {
        fprintf(stderr, "usage: %s PREFIX [NUMBER OF SPARKS]\n", argv[0]);
        return 2;
    }
    int is_bad = failed(energywave_check_abi(ENERGYWAVE_ABI)) || failed(energywave_suit_drivers()) ||
                 open_host(&host) || failed(energywave_scene_from_text(SCENE, NULL, &scene)) ||
                 failed(energywave_renderer_on_host(host.context, host.queue, NULL, &renderer));
    for (int step = 0; step < FRAMES && !is_bad; step++) {
        char path[4096];
        snprintf(path, sizeof path, "%s-%d.png", argv[1], step);
        is_bad = draw(&host, renderer, scene, light, 0.04f * (float)step) ||
                 failed(energywave_save(scene, light, sizeof light, 0, 0, path));
    }
    energywave_renderer_free(renderer);
    energywave_scene_free(scene);
    close_host(&host);
    return is_bad;
}
