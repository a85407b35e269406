/* Frames of a host with OpenCL of its own: its buffers and images as targets, its depths in a buffer and in an image,
 * its events, what does not fit. What a frame must be is what energywave_render gives of a scene with the same depths.
 *
 *   host FOLDER   (of a file of depths)
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "common.h"

#include <math.h>
#include <stdlib.h>

enum { PIXELS = WIDTH * HEIGHT, PITCH = WIDTH + 3, OFFSET = PITCH + 2 };

/* Digits of half floats. */
static const double HALF = 1e-3;

typedef struct {
    cl_context context;
    cl_command_queue queue;
    cl_mem target;
    energywave_renderer *renderer;
    energywave_scene *scene;
} Host;

/* The scene, the same behind depths along the ray and along the axis of view, and those. */
static float lengths[PIXELS];
static float open_light[VALUES], behind_ray[VALUES], behind_axis[VALUES];

static cl_mem stored(cl_context context, size_t bytes, const void *values) {
    const cl_mem_flags flags = CL_MEM_READ_WRITE | (values == NULL ? 0 : CL_MEM_COPY_HOST_PTR);
    cl_int code = CL_SUCCESS;
    const cl_mem memory = clCreateBuffer(context, flags, bytes, (void *)values, &code);
    holds(code == CL_SUCCESS, "the host's buffer");
    return memory;
}

static cl_mem pictured(cl_context context, cl_channel_order order, cl_channel_type type, const void *values) {
    const cl_image_format format = {order, type};
    const cl_image_desc shape = {.image_type = CL_MEM_OBJECT_IMAGE2D, .image_width = WIDTH, .image_height = HEIGHT};
    const cl_mem_flags flags = CL_MEM_READ_WRITE | (values == NULL ? 0 : CL_MEM_COPY_HOST_PTR);
    cl_int code = CL_SUCCESS;
    const cl_mem memory = clCreateImage(context, flags, &format, &shape, (void *)values, &code);
    holds(code == CL_SUCCESS, "the host's image");
    return memory;
}

static energywave_frame frame_into(cl_mem target, uint32_t kind) {
    return (energywave_frame){.struct_size = sizeof(energywave_frame), .target = target, .target_kind = kind};
}

/* Draws into the host's buffer and reads it after the frame's event. */
static void draw(const Host *host, const energywave_frame *frame, float *light) {
    cl_event drawn = NULL;
    works(energywave_enqueue(host->renderer, host->scene, frame, &drawn), "a frame");
    const cl_int code =
        clEnqueueReadBuffer(host->queue, frame->target, CL_TRUE, 0, VALUES * sizeof(float), light, 1, &drawn, NULL);
    holds(code == CL_SUCCESS, "the frame is read");
    holds(clReleaseEvent(drawn) == CL_SUCCESS, "the event is the caller's");
}

static int is_same(const float *found, const float *expected) {
    return memcmp(found, expected, VALUES * sizeof(float)) == 0;
}

static float float_of_half(uint16_t half) {
    const int exponent = half >> 10 & 31;
    return ldexpf((float)(half & 1023) + (exponent > 0 ? 1024.0f : 0.0f), (exponent > 0 ? exponent : 1) - 25);
}

static void targets(const Host *host) {
    static float light[VALUES], pixels[VALUES];
    static uint16_t halves[VALUES];
    const size_t origin[3] = {0, 0, 0}, region[3] = {WIDTH, HEIGHT, 1};
    const energywave_frame frame = frame_into(host->target, ENERGYWAVE_BUFFER);
    draw(host, &frame, light);
    holds(is_same(light, open_light), "a buffer gets the light of render, to the bit");
    works(energywave_enqueue(host->renderer, host->scene, &frame, NULL), "a frame whose event nobody wants");
    for (int is_half = 0; is_half < 2; is_half++) {
        const cl_mem image = pictured(host->context, CL_RGBA, is_half ? CL_HALF_FLOAT : CL_FLOAT, NULL);
        const energywave_frame into = frame_into(image, ENERGYWAVE_IMAGE);
        void *const values = is_half ? (void *)halves : (void *)pixels;
        works(energywave_enqueue(host->renderer, host->scene, &into, NULL), "a frame into an image");
        /* An in-order queue needs no event. */
        holds(clEnqueueReadImage(host->queue, image, CL_TRUE, origin, region, 0, 0, values, 0, NULL, NULL) ==
                  CL_SUCCESS,
              "the image is read");
        clReleaseMemObject(image);
    }
    holds(is_same(pixels, open_light), "an image of floats gets it, too");
    double most = 0.0;
    for (int i = 0; i < VALUES; i++) {
        most = fmax(most, fabs(float_of_half(halves[i]) - open_light[i]) / fmax(open_light[i], 1e-3));
    }
    holds(most > 0.0 && most < HALF, "an image of half floats gets it with their digits");
}

/* Every way to have depths gives the picture of the scene's own; and another one where it is told wrong. */
static void depths(const Host *host) {
    static float light[VALUES], padded[PITCH * (HEIGHT + 1)], four[VALUES];
    energywave_frame frame = frame_into(host->target, ENERGYWAVE_BUFFER);
    const energywave_frame without = frame;
    for (int row = 0; row < HEIGHT; row++) {
        for (int column = 0; column < WIDTH; column++) {
            const float length = lengths[row * WIDTH + column];
            padded[OFFSET + (HEIGHT - 1 - row) * PITCH + column] = 0.5f * length;
            four[4 * (row * WIDTH + column)] = length;
        }
    }
    const cl_mem tight = stored(host->context, sizeof lengths, lengths);
    const cl_mem wide = stored(host->context, sizeof padded, padded);
    const cl_mem one_channel = pictured(host->context, CL_R, CL_FLOAT, lengths);
    const cl_mem four_channels = pictured(host->context, CL_RGBA, CL_FLOAT, four);

    frame.depth = tight;
    frame.depth_kind = ENERGYWAVE_BUFFER;
    draw(host, &frame, light);
    holds(is_same(light, behind_ray), "depths of a buffer");
    frame.depth_along = "axis";
    draw(host, &frame, light);
    holds(is_same(light, behind_axis) && !is_same(light, behind_ray), "depths along the axis of view");

    frame.depth = wide;
    frame.depth_along = "ray";
    frame.depth_is_bottom_up = 1;
    frame.depth_scale = 2.0;
    frame.depth_offset = OFFSET * sizeof(float);
    frame.depth_row_pitch = PITCH * sizeof(float);
    draw(host, &frame, light);
    holds(is_same(light, behind_ray), "depths with gaps, from the lowest row, in other units");
    frame.depth_is_bottom_up = 0;
    draw(host, &frame, light);
    holds(!is_same(light, behind_ray), "the wrong way up they are others");
    frame.depth_is_bottom_up = 1;
    frame.depth_offset -= sizeof(float);
    draw(host, &frame, light);
    holds(!is_same(light, behind_ray), "a pixel aside they are others");

    for (int i = 0; i < 2; i++) {
        frame = without;
        frame.depth = i == 0 ? one_channel : four_channels;
        frame.depth_kind = ENERGYWAVE_IMAGE;
        draw(host, &frame, light);
        holds(is_same(light, behind_ray), "depths of an image");
        frame.depth_along = "axis";
        draw(host, &frame, light);
        holds(is_same(light, behind_axis), "depths of an image along the axis");
    }
    draw(host, &without, light);
    holds(is_same(light, open_light), "depths are those of one frame");
    clReleaseMemObject(tight);
    clReleaseMemObject(wide);
    clReleaseMemObject(one_channel);
    clReleaseMemObject(four_channels);
}

static int is_over(cl_event event) {
    cl_int state = CL_QUEUED;
    clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof state, &state, NULL);
    return state == CL_COMPLETE;
}

/* A frame waits for what writes its depths, on another queue, and that for the host. */
static void events(const Host *host) {
    static float light[VALUES], far_away[PIXELS];
    cl_int code = CL_SUCCESS;
    cl_device_id device;
    cl_event written = NULL, drawn = NULL;
    for (int i = 0; i < PIXELS; i++) {
        far_away[i] = INFINITY;
    }
    holds(clGetCommandQueueInfo(host->queue, CL_QUEUE_DEVICE, sizeof device, &device, NULL) == CL_SUCCESS, "a device");
    const cl_command_queue other = clCreateCommandQueue(host->context, device, 0, &code);
    const cl_mem depth = stored(host->context, sizeof far_away, far_away);
    const cl_event gate = clCreateUserEvent(host->context, &code);
    energywave_frame frame = frame_into(host->target, ENERGYWAVE_BUFFER);
    frame.depth = depth;
    frame.depth_kind = ENERGYWAVE_BUFFER;
    draw(host, &frame, light);
    holds(is_same(light, open_light), "depths that are infinite hide nothing");
    holds(clEnqueueWriteBuffer(other, depth, CL_FALSE, 0, sizeof lengths, lengths, 1, &gate, &written) == CL_SUCCESS,
          "other depths, when the host says so");
    clFlush(other);
    frame.wait_list = &written;
    frame.wait_count = 1;
    works(energywave_enqueue(host->renderer, host->scene, &frame, &drawn), "a frame after an event");
    holds(!is_over(written) && !is_over(drawn),
          "the call comes back before the host's event, the frame does not begin");
    clSetUserEventStatus(gate, CL_COMPLETE);
    holds(clWaitForEvents(1, &drawn) == CL_SUCCESS && is_over(written), "the frame ends after the event");
    clEnqueueReadBuffer(other, host->target, CL_TRUE, 0, sizeof light, light, 0, NULL, NULL);
    holds(is_same(light, behind_ray), "it has the depths that came with the event");
    clReleaseEvent(gate);
    clReleaseEvent(written);
    clReleaseEvent(drawn);
    clReleaseMemObject(depth);
    clReleaseCommandQueue(other);
}

/* What does not fit is refused before anything is enqueued: the target stays as it is. */
static void misfits(const Host *host) {
    static const float before = -7.0f;
    static float light[VALUES];
    const energywave_status misfit = ENERGYWAVE_STATUS_HOST, argument = ENERGYWAVE_STATUS_BAD_ARGUMENT;
    cl_device_id device;
    cl_int code = CL_SUCCESS;
    cl_event nothing = NULL;
    for (int i = 0; i < VALUES; i++) {
        light[i] = before;
    }
    clGetCommandQueueInfo(host->queue, CL_QUEUE_DEVICE, sizeof device, &device, NULL);
    const cl_context elsewhere = clCreateContext(NULL, 1, &device, NULL, NULL, &code);
    const cl_mem foreign = stored(elsewhere, sizeof light, NULL);
    const cl_mem target = stored(host->context, sizeof light, light);
    const cl_mem small = stored(host->context, sizeof light - 4, NULL);
    const cl_mem depth = stored(host->context, sizeof lengths, lengths);
    const cl_mem bytes = pictured(host->context, CL_RGBA, CL_UNORM_INT8, NULL);
    const cl_event event = clCreateUserEvent(elsewhere, &code);
    energywave_frame frame = frame_into(NULL, ENERGYWAVE_BUFFER), behind;
#define REFUSED(CHANGE, STATUS, WORDS)                                                                                 \
    do {                                                                                                               \
        CHANGE;                                                                                                        \
        fails(energywave_enqueue(host->renderer, host->scene, &behind, &nothing), STATUS, WORDS);                      \
        behind = frame;                                                                                                \
    } while (0)
    behind = frame;
    REFUSED((void)0, misfit, "null");
    REFUSED(behind.target = foreign, misfit, "context");
    REFUSED(behind.target = small, misfit, "1532 bytes");
    REFUSED(behind.target = bytes, misfit, "buffer");
    REFUSED((behind.target = bytes, behind.target_kind = ENERGYWAVE_IMAGE), misfit, "CL_RGBA");
    frame.target = behind.target = target;
    REFUSED((behind.wait_list = &event, behind.wait_count = 1), misfit, "context");
    REFUSED((behind.wait_list = &nothing, behind.wait_count = 1), misfit, "null");
    frame.depth = behind.depth = depth;
    REFUSED((void)0, argument, "frame.depth_kind: 0");
    frame.depth_kind = behind.depth_kind = ENERGYWAVE_BUFFER;
    REFUSED(behind.depth = foreign, misfit, "context");
    REFUSED(behind.depth = target, misfit, "the same memory");
    REFUSED(behind.depth = bytes, misfit, "buffer");
    REFUSED((behind.depth = bytes, behind.depth_kind = ENERGYWAVE_IMAGE), misfit, "CL_UNORM_INT8");
    REFUSED(behind.depth_kind = ENERGYWAVE_IMAGE, misfit, "image");
    REFUSED(behind.depth_offset = 4, misfit, "need 388");
    REFUSED(behind.depth_row_pitch = 8, misfit, "row pitch of 8");
    REFUSED(behind.depth_scale = (double)NAN, misfit, "a scale of NaN");
    REFUSED(behind.depth_along = "z", argument, "\"z\" is none; use ray, axis, ndc, buffer");
    REFUSED(behind.depth_along = "buffer", misfit, "view and projection");
    REFUSED(behind.depth_is_bottom_up = 2, argument, "frame.depth_is_bottom_up: 2");
    holds(nothing == NULL, "a call that fails gives no event");
    clEnqueueReadBuffer(host->queue, target, CL_TRUE, 0, sizeof light, light, 0, NULL, NULL);
    for (int i = 0; i < VALUES; i++) {
        light[0] = light[i] == before ? light[0] : 0.0f;
    }
    holds(light[0] == before, "what was refused has drawn nothing");
    draw(host, &frame, light);
    holds(is_same(light, behind_ray), "the next frame is right");
    clReleaseMemObject(foreign);
    clReleaseMemObject(target);
    clReleaseMemObject(small);
    clReleaseMemObject(depth);
    clReleaseMemObject(bytes);
    clReleaseEvent(event);
    clReleaseContext(elsewhere);
}

static energywave_scene *behind(const char *folder, const char *along) {
    char text[2048];
    energywave_scene *scene = NULL;
    snprintf(text, sizeof text, "%s[depth]\nfile = \"depth.f32\"\nalong = \"%s\"\n", SMALL, along);
    works(energywave_scene_from_text(text, folder, &scene), "a scene with depths of its own");
    return scene;
}

/* A surface that is cut through, nothing on the right, all hidden below. */
static void make_depths(const char *folder) {
    char path[4096];
    for (int i = 0; i < PIXELS; i++) {
        const int column = i % WIDTH, row = i / WIDTH;
        lengths[i] = row == HEIGHT - 1 ? 0.0f : column == WIDTH - 1 ? INFINITY : 3.7f + 0.1f * (float)(column + row);
    }
    snprintf(path, sizeof path, "%s/depth.f32", folder);
    FILE *const file = fopen(path, "wb");
    holds(file != NULL && fwrite(lengths, sizeof lengths, 1, file) == 1 && fclose(file) == 0, "a file of depths");
}

static void render_expected(const Host *host, const char *folder) {
    energywave_scene *const along_ray = behind(folder, "ray"), *const along_axis = behind(folder, "axis");
    works(energywave_render(host->renderer, host->scene, open_light, sizeof open_light, 0), "the scene");
    works(energywave_render(host->renderer, along_ray, behind_ray, sizeof behind_ray, 0), "behind depths");
    works(energywave_render(host->renderer, along_axis, behind_axis, sizeof behind_axis, 0), "behind others");
    holds(!is_same(open_light, behind_ray) && !is_same(behind_ray, behind_axis), "depths end rays");
    energywave_frame frame = frame_into(host->target, ENERGYWAVE_BUFFER);
    frame.depth = host->target;
    frame.depth_kind = ENERGYWAVE_BUFFER;
    fails(energywave_enqueue(host->renderer, along_ray, &frame, NULL), ENERGYWAVE_STATUS_HOST, "depth of its own");
    works(energywave_scene_free(along_ray), "it is freed");
    works(energywave_scene_free(along_axis), "it is freed");
}

int main(int argc, char **argv) {
    const char *const folder = argc > 1 ? argv[1] : ".";
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
    host.target = stored(host.context, VALUES * sizeof(float), NULL);
    works(energywave_scene_from_text(SMALL, NULL, &host.scene), "a scene");
    works(energywave_renderer_on_host(host.context, host.queue, NULL, &host.renderer),
          "a renderer on the host's queue");
    make_depths(folder);
    render_expected(&host, folder);
    targets(&host);
    depths(&host);
    events(&host);
    misfits(&host);
    works(energywave_renderer_free(host.renderer), "the renderer is freed");
    works(energywave_scene_free(host.scene), "the scene is freed");
    clReleaseMemObject(host.target);
    clReleaseCommandQueue(host.queue);
    clReleaseContext(host.context);
    return finish("host");
}
