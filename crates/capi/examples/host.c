/* A host with OpenCL of its own: waves are drawn on its context and queue into its image, after its events, and nothing
 * is read back until the host does. Writes HOST.png.
 *
 *   cc host.c $(pkg-config --cflags --libs energywave) -lOpenCL -o host
 *   ./host HOST.png
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <energywave.h>
#include <stdio.h>
#include <stdlib.h>

enum { WIDTH = 160, HEIGHT = 120 };

static const char *const SCENE = "[camera]\n"
                                 "eye = [0, -4, 2]\n"
                                 "target = [0, 0, 0]\n"
                                 "[image]\n"
                                 "width = 160\n"
                                 "height = 120\n"
                                 "[[torus]]\n"
                                 "color = [1, 0.5, 0.15]\n"
                                 "coefficient = 0.008\n"
                                 "major_radius = { times = [0, 2], values = [0.7, 1.0] }\n";

static int failed(energywave_status status) {
    energywave_error error = {0};
    if (status == ENERGYWAVE_STATUS_OK) {
        return 0;
    }
    error.struct_size = sizeof error;
    energywave_last_error(&error);
    fprintf(stderr, "error (%s): %s\n", error.code, error.message);
    return 1;
}

/* What every host has anyway. */
typedef struct {
    cl_context context;
    cl_command_queue queue;
    cl_mem image;
} Host;

static int open_host(Host *host) {
    const cl_image_format format = {CL_RGBA, CL_FLOAT};
    const cl_image_desc shape = {.image_type = CL_MEM_OBJECT_IMAGE2D, .image_width = WIDTH, .image_height = HEIGHT};
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
    if (code == CL_SUCCESS) {
        host->image = clCreateImage(host->context, CL_MEM_READ_WRITE, &format, &shape, NULL, &code);
    }
    if (code != CL_SUCCESS) {
        fprintf(stderr, "the host's OpenCL: error %d\n", code);
    }
    return code != CL_SUCCESS;
}

static void close_host(const Host *host) {
    if (host->image != NULL) {
        clReleaseMemObject(host->image);
    }
    if (host->queue != NULL) {
        clReleaseCommandQueue(host->queue);
    }
    if (host->context != NULL) {
        clReleaseContext(host->context);
    }
}

/* Draws three frames; each call comes back at once, and the host's queue goes on when the frame is drawn. */
static int draw(const Host *host, energywave_renderer *renderer, energywave_scene *scene) {
    energywave_frame frame = {.struct_size = sizeof frame, .target = host->image, .target_kind = ENERGYWAVE_IMAGE};
    for (int step = 0; step < 3; step++) {
        cl_event drawn = NULL;
        if (failed(energywave_scene_set_time(scene, step)) ||
            failed(energywave_enqueue(renderer, scene, &frame, &drawn))) {
            return 1;
        }
        /* Other queues wait for the event; so may the host. */
        const cl_int code = clWaitForEvents(1, &drawn);
        clReleaseEvent(drawn);
        if (code != CL_SUCCESS) {
            fprintf(stderr, "frame %d: error %d\n", step, code);
            return 1;
        }
    }
    return 0;
}

/* The host's own use of the image; here it is saved. */
static int save(const Host *host, const energywave_scene *scene, const char *path) {
    static float light[4 * WIDTH * HEIGHT];
    const size_t origin[3] = {0, 0, 0};
    const size_t region[3] = {WIDTH, HEIGHT, 1};
    const cl_int code =
        clEnqueueReadImage(host->queue, host->image, CL_TRUE, origin, region, 0, 0, light, 0, NULL, NULL);
    if (code != CL_SUCCESS) {
        fprintf(stderr, "reading the image: error %d\n", code);
        return 1;
    }
    return failed(energywave_save(scene, light, sizeof light, 0, 0, path));
}

int main(int argc, char **argv) {
    Host host = {0};
    energywave_scene *scene = NULL;
    energywave_renderer *renderer = NULL;
    if (argc != 2) {
        fprintf(stderr, "usage: %s HOST.png\n", argv[0]);
        return 2;
    }
    const int is_bad = failed(energywave_check_abi(ENERGYWAVE_ABI)) || failed(energywave_suit_drivers()) ||
                       open_host(&host) || failed(energywave_scene_from_text(SCENE, NULL, &scene)) ||
                       failed(energywave_renderer_on_host(host.context, host.queue, NULL, &renderer)) ||
                       draw(&host, renderer, scene) || save(&host, scene, argv[1]);
    energywave_renderer_free(renderer);
    energywave_scene_free(scene);
    close_host(&host);
    return is_bad;
}
