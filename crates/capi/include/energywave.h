/* energywave for C and C++: beams, rings and curves of light, integrated along every view ray.
 *
 * Every call gives a status; what went wrong is kept for the calling thread: energywave_last_error. Handles may be used by
 * several threads at once: calls on one renderer wait for each other, those on scenes hardly do. A handle that was freed,
 * or is of another kind, is an error. Structs begin with struct_size, which the caller sets to their sizeof and the rest
 * to 0: a program and a library of other versions then understand each other.
 */

#ifndef ENERGYWAVE_H
#define ENERGYWAVE_H

/* Made by cbindgen of crates/capi/src; do not change it here. */

#include <stddef.h>
#include <stdint.h>

/**
 * The version of this header. Calls and fields are added without changing it; what breaks callers does.
 */
#define ENERGYWAVE_ABI 1

/**
 * A memory object is a buffer.
 */
#define ENERGYWAVE_BUFFER 1

/**
 * A memory object is an image.
 */
#define ENERGYWAVE_IMAGE 2

/**
 * What a call comes back with. The numbers never change; new ones may come.
 */
enum energywave_status
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /**
   * It did what was asked.
   */
  ENERGYWAVE_STATUS_OK = 0,
  /**
   * A value of the scene cannot be drawn; file, line, column and key where they are known.
   */
  ENERGYWAVE_STATUS_SCENE = 1,
  /**
   * An input file cannot be read.
   */
  ENERGYWAVE_STATUS_INPUT = 2,
  /**
   * The device, or this build of the library, lacks what is asked for.
   */
  ENERGYWAVE_STATUS_UNSUPPORTED = 3,
  /**
   * No device answers to the choice, or more than one.
   */
  ENERGYWAVE_STATUS_NO_SUCH_DEVICE = 4,
  /**
   * The device's compiler refused the kernels; its log is in the message.
   */
  ENERGYWAVE_STATUS_BUILD = 5,
  /**
   * Kernels gave a wrong answer where the right one is known.
   */
  ENERGYWAVE_STATUS_SELF_TEST = 6,
  /**
   * A call to OpenCL failed.
   */
  ENERGYWAVE_STATUS_DEVICE = 7,
  /**
   * Something of the host's OpenCL does not fit; nothing was enqueued.
   */
  ENERGYWAVE_STATUS_HOST = 8,
  /**
   * Device or host have too little memory.
   */
  ENERGYWAVE_STATUS_OUT_OF_MEMORY = 9,
  /**
   * The name of an output says no known format.
   */
  ENERGYWAVE_STATUS_OUTPUT_FORMAT = 10,
  /**
   * An output cannot be written; nothing is left behind.
   */
  ENERGYWAVE_STATUS_OUTPUT = 11,
  /**
   * The work was stopped.
   */
  ENERGYWAVE_STATUS_INTERRUPTED = 12,
  /**
   * A failure that has no number yet; its code has a name.
   */
  ENERGYWAVE_STATUS_OTHER = 13,
  /**
   * An argument is NULL where it may not be, has a wrong size or alignment, or is no UTF-8.
   */
  ENERGYWAVE_STATUS_BAD_ARGUMENT = 100,
  /**
   * A handle was freed, is of another kind, or is none.
   */
  ENERGYWAVE_STATUS_BAD_HANDLE = 101,
  /**
   * A struct, or the header, is of another version than this library understands.
   */
  ENERGYWAVE_STATUS_BAD_VERSION = 102,
  /**
   * A fault of the library itself. A renderer that it happened in is of no use any more.
   */
  ENERGYWAVE_STATUS_INTERNAL = 103,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum energywave_status energywave_status;
#else
typedef int32_t energywave_status;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/**
 * OpenCL's context, `cl_context` without its `*`.
 */
typedef struct _cl_context _cl_context;

/**
 * OpenCL's event, `cl_event` without its `*`.
 */
typedef struct _cl_event _cl_event;

/**
 * OpenCL's memory object, `cl_mem` without its `*`.
 */
typedef struct _cl_mem _cl_mem;

/**
 * OpenCL's queue, `cl_command_queue` without its `*`.
 */
typedef struct _cl_command_queue _cl_command_queue;

/**
 * A renderer.
 */
typedef struct energywave_renderer energywave_renderer;

/**
 * A scene.
 */
typedef struct energywave_scene energywave_scene;

/**
 * What is known of the last call of this thread that failed. Texts are UTF-8, never NULL, empty where nothing is
 * known, and stay until the next call of this thread that fails.
 */
typedef struct energywave_error {
  /**
   * `sizeof` of this struct, set by the caller.
   */
  size_t struct_size;
  /**
   * What that call came back with; ENERGYWAVE_STATUS_OK if none has failed.
   */
  energywave_status status;
  /**
   * The line in the scene's text, from 1; 0: not known.
   */
  uint32_t line;
  /**
   * The column in it, from 1; 0: not known.
   */
  uint32_t column;
  /**
   * 0.
   */
  uint32_t reserved;
  /**
   * The name of the status, such as `no-such-device`; it never changes.
   */
  const char *code;
  /**
   * What went wrong, where, why, and what to do.
   */
  const char *message;
  /**
   * The file at fault.
   */
  const char *path;
  /**
   * The key of the scene at fault, such as `torus[1].axis`.
   */
  const char *key;
  /**
   * What to do, alone.
   */
  const char *remedy;
} energywave_error;

/**
 * A device. Texts are UTF-8, end with a 0, and are cut where they are longer.
 */
typedef struct energywave_device {
  /**
   * `sizeof` of this struct, set by the caller.
   */
  size_t struct_size;
  /**
   * Its place among all devices; it may change when drivers are installed.
   */
  uint32_t index;
  /**
   * 1 if it is the one that is chosen where nothing else is said, else 0.
   */
  uint32_t is_default;
  /**
   * Memory, bytes.
   */
  uint64_t memory_bytes;
  /**
   * The largest single allocation, bytes.
   */
  uint64_t max_allocation_bytes;
  /**
   * Compute units, or threads.
   */
  uint32_t compute_units;
  /**
   * Rays that a work-item carries side by side.
   */
  uint32_t lanes;
  /**
   * `gpu`, `cpu`, `accelerator` or `reference`.
   */
  char device_type[16];
  /**
   * Its name.
   */
  char name[128];
  /**
   * The name of its OpenCL platform.
   */
  char platform[128];
  /**
   * Its OpenCL version.
   */
  char version[128];
  /**
   * The version of its driver.
   */
  char driver[64];
} energywave_device;

/**
 * What takes the place of values of a scene's text; what is 0 or NULL leaves them.
 */
typedef struct energywave_overrides {
  /**
   * `sizeof` of this struct.
   */
  size_t struct_size;
  /**
   * Width of the image, pixels; with a height.
   */
  uint32_t width;
  /**
   * Height of the image, pixels.
   */
  uint32_t height;
  /**
   * `exact`, `simpson` or `jittered`.
   */
  const char *method;
  /**
   * `tiles` or `pixels`; asks for `exact` where no method is named.
   */
  const char *sampling;
  /**
   * `footprint` or `none`.
   */
  const char *antialias;
  /**
   * The relative error that `exact` aims at; asks for it where no method is named.
   */
  double tolerance;
  /**
   * Divisions of `simpson` (even) or `jittered`; asks for a sum where no method is named.
   */
  uint32_t divisions;
  /**
   * 0.
   */
  uint32_t reserved;
} energywave_overrides;

/**
 * What a scene is.
 */
typedef struct energywave_scene_info {
  /**
   * `sizeof` of this struct, set by the caller.
   */
  size_t struct_size;
  /**
   * Width of the image, pixels.
   */
  uint32_t width;
  /**
   * Height of the image, pixels.
   */
  uint32_t height;
  /**
   * Sources of light.
   */
  uint64_t sources;
  /**
   * The time that it shows, seconds.
   */
  double time;
  /**
   * After how many seconds it begins again; 0: it does not say.
   */
  double period;
  /**
   * 1 if something of it changes over time, else 0.
   */
  uint32_t is_animated;
  /**
   * How many lines energywave_scene_warnings has.
   */
  uint32_t warnings;
} energywave_scene_info;

/**
 * Choices of a renderer; what is 0 suits the device.
 */
typedef struct energywave_options {
  /**
   * `sizeof` of this struct.
   */
  size_t struct_size;
  /**
   * Rays that a work-item carries side by side: 1, 4, 8 or 16.
   */
  uint32_t lanes;
  /**
   * Work-items that share a tile: 1, 2, 4, 8, 16 or 32.
   */
  uint32_t tile_workers;
  /**
   * 1: samples are counted for energywave_renderer_cost.
   */
  uint32_t counts_samples;
  /**
   * 1: kernels draw without having shown that they compute right.
   */
  uint32_t skips_self_test;
  /**
   * 1: frames have the bloom of their scene. Tell energywave_tone_map and energywave_save so.
   */
  uint32_t spreads_bloom;
  /**
   * Kernels on disk; 0: for drivers that keep none, 1: always, 2: never.
   */
  uint32_t kernel_cache;
} energywave_options;

/**
 * What a frame cost.
 */
typedef struct energywave_cost {
  /**
   * `sizeof` of this struct, set by the caller.
   */
  size_t struct_size;
  /**
   * Time that the device worked on kernels, seconds.
   */
  double kernel_seconds;
  /**
   * Pairs of a ray and a source.
   */
  uint64_t integrals;
  /**
   * Samples of fields; 0 where they were not counted.
   */
  uint64_t samples;
  /**
   * Launches of kernels.
   */
  uint64_t launches;
} energywave_cost;

/**
 * Points of light in a host's own buffers, in any number: a particle system lives there. They are drawn as the same
 * `[[points]]` of a scene, to the bit.
 */
typedef struct energywave_points {
  /**
   * `sizeof` of this struct.
   */
  size_t struct_size;
  /**
   * A buffer of float4, one for each point: x, y and z, world units; the fourth is not looked at.
   */
  struct _cl_mem *positions;
  /**
   * A buffer of float4, one for each point: linear red, green and blue; the fourth is not looked at. NULL: all have
   * `color`.
   */
  struct _cl_mem *lights;
  /**
   * How many points there are, from the beginning of the buffers.
   */
  size_t count;
  /**
   * What the light of each is multiplied with; it has no other value than what is given, and 0 is no light.
   */
  double coefficient;
  /**
   * Linear red, green and blue of points that have no lights of their own.
   */
  double color[3];
  /**
   * How their light falls off: `inverse`, `inverse-square` or `smeared`; NULL: `inverse-square`.
   */
  const char *profile;
  /**
   * A buffer of float4, one for each point: where it was. Its light lies evenly along the way from there, as of a
   * spark that flies, and falls off by `inverse`, without a radius; the fourth is not looked at. NULL: points have
   * not moved.
   */
  struct _cl_mem *previous;
  /**
   * How thick they are, world units: of `smeared`, which needs one, the standard deviation of a ball of light. Of
   * the others each is then drawn by itself, which is slow for many; 0: they are points.
   */
  double radius;
} energywave_points;

/**
 * Where a frame of a host goes, and what it waits for.
 */
typedef struct energywave_frame {
  /**
   * `sizeof` of this struct.
   */
  size_t struct_size;
  /**
   * Where light goes. A buffer of float32, four values a pixel, by rows from the top left, made with
   * `CL_MEM_READ_WRITE`; or a 2D image of the scene's size, `CL_RGBA` of `CL_FLOAT` or `CL_HALF_FLOAT`.
   */
  struct _cl_mem *target;
  /**
   * ENERGYWAVE_BUFFER or ENERGYWAVE_IMAGE.
   */
  uint32_t target_kind;
  /**
   * How many events the frame waits for, besides what is on the host's queue.
   */
  uint32_t wait_count;
  /**
   * The events; NULL if there are none.
   */
  struct _cl_event *const *wait_list;
  /**
   * Depths that end the rays, one a pixel; NULL: nothing hides the light.
   */
  struct _cl_mem *depth;
  /**
   * ENERGYWAVE_BUFFER: float32. ENERGYWAVE_IMAGE: the first channel of `CL_R`, `CL_DEPTH` or `CL_RGBA`.
   */
  uint32_t depth_kind;
  /**
   * 1: the first row of depths is the lowest, as OpenGL draws.
   */
  uint32_t depth_is_bottom_up;
  /**
   * `ray`, `axis`, or of the scene's camera matrices `ndc` or `buffer`; NULL: `ray`.
   */
  const char *depth_along;
  /**
   * World units to a unit of depth; 0: 1.
   */
  double depth_scale;
  /**
   * Of a buffer: where the first row of depths begins, bytes.
   */
  size_t depth_offset;
  /**
   * Of a buffer: from row to row of depths, bytes; 0: no gap.
   */
  size_t depth_row_pitch;
  /**
   * Points of light besides the scene's, an array; NULL if there are none.
   */
  const struct energywave_points *points;
  /**
   * How many elements that array has.
   */
  uint32_t points_count;
  /**
   * 0.
   */
  uint32_t reserved;
} energywave_frame;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Returns the version of the library, such as `0.1.0`. It is never freed.
 */
const char *energywave_version(void);

/**
 * Checks that the library that was loaded keeps to the header that a program was compiled with: `abi` is
 * ENERGYWAVE_ABI. Call it once, first.
 */
energywave_status energywave_check_abi(uint32_t abi);

/**
 * Sets in the environment what drivers need and lack: PoCL's threads, its linker, its cache. Call it first in `main`,
 * if at all: no other thread may run yet.
 *
 * # Safety
 * No other thread runs.
 */
energywave_status energywave_suit_drivers(void);

/**
 * Tells about the last call of this thread that failed. `error` has its `struct_size` set.
 *
 * # Safety
 * `error` points to so many bytes.
 */
energywave_status energywave_last_error(struct energywave_error *error);

/**
 * Gives all devices as a JSON text, an array of objects: `index`, `name`, `type`, `platform`, `version`, `driver`,
 * `compute_units`, `memory_bytes`, `max_allocation_bytes`, `form`, `lanes`, `tile_workers`, `default`. The last is the
 * built-in reference, so that there is always one. `*json` is freed by energywave_text_free.
 *
 * # Safety
 * `json` points to a place for a pointer.
 */
energywave_status energywave_devices(char **json);

/**
 * Frees a text that this library gave; NULL is none.
 *
 * # Safety
 * Nothing uses the text any more. Any other pointer is an error, ENERGYWAVE_STATUS_BAD_HANDLE.
 */
energywave_status energywave_text_free(char *text);

/**
 * Tells about the device that a choice names; see energywave_renderer_new. `info` has its `struct_size` set.
 *
 * # Safety
 * `choice` is NULL or ends with a 0; `info` points to as many bytes as it says.
 */
energywave_status energywave_device_describe(const char *choice,
                                             struct energywave_device *info);

/**
 * Reads a scene file; the ending chooses: `.json` is JSON, everything else TOML. `*scene` is freed by
 * energywave_scene_free; where the call fails, it stays as it was.
 *
 * # Safety
 * `path` ends with a 0; `scene` points to a place for a pointer.
 */
energywave_status energywave_scene_from_file(const char *path,
                                             struct energywave_scene **scene);

/**
 * Reads a scene in UTF-8, JSON if it begins with `{`, else TOML. Files that it names are from `folder`; NULL: from the
 * working folder. `*scene` is as of energywave_scene_from_file.
 *
 * # Safety
 * `text` ends with a 0, `folder` too or it is NULL; `scene` points to a place for a pointer.
 */
energywave_status energywave_scene_from_text(const char *text,
                                             const char *folder,
                                             struct energywave_scene **scene);

/**
 * Frees a scene; NULL is none. Calls of other threads that use it come to their end.
 */
energywave_status energywave_scene_free(struct energywave_scene *scene);

/**
 * Replaces values of the scene's text, instead of those that were replaced before; NULL: by none. Where the call
 * fails, the scene stays as it was.
 *
 * # Safety
 * `overrides` is NULL, or points to as many bytes as it says; its texts are NULL or end with a 0.
 */
energywave_status energywave_scene_override(struct energywave_scene *scene,
                                            const struct energywave_overrides *overrides);

/**
 * Goes to another time, seconds. Where the call fails, the scene stays as it was.
 */
energywave_status energywave_scene_set_time(struct energywave_scene *scene, double seconds);

/**
 * Tells what a scene is. `info` has its `struct_size` set.
 *
 * # Safety
 * `info` points to as many bytes as it says.
 */
energywave_status energywave_scene_describe(const struct energywave_scene *scene,
                                            struct energywave_scene_info *info);

/**
 * Gives what can be drawn and was hardly meant, such as angles in radians, a line each. `*text` is freed by
 * energywave_text_free.
 *
 * # Safety
 * `text` points to a place for a pointer.
 */
energywave_status energywave_scene_warnings(const struct energywave_scene *scene,
                                            char **text);

/**
 * Opens a device: `choice` is an index, `gpu`, `cpu`, `reference`, or a part of a device's name; several with commas
 * between, or `all`, share every frame. NULL: the best OpenCL device, and an error where there is none. `options` may
 * be NULL. `*renderer` is freed by energywave_renderer_free; where the call fails, it stays as it was.
 *
 * # Safety
 * `choice` is NULL or ends with a 0; `options` is NULL or points to as many bytes as it says; `renderer` points to a
 * place for a pointer.
 */
energywave_status energywave_renderer_new(const char *choice,
                                          const struct energywave_options *options,
                                          struct energywave_renderer **renderer);

/**
 * Makes a renderer on a host's OpenCL, for the device of the host's queue; it keeps a reference to both. `*renderer`
 * is as of energywave_renderer_new.
 *
 * # Safety
 * `context` and `queue` are a `cl_context` and a `cl_command_queue` that are alive, or NULL, which is an error; the
 * rest is as of energywave_renderer_new.
 */
energywave_status energywave_renderer_on_host(struct _cl_context *context,
                                              struct _cl_command_queue *queue,
                                              const struct energywave_options *options,
                                              struct energywave_renderer **renderer);

/**
 * Frees a renderer; NULL is none. Waits until its device has read what was uploaded. Calls of other threads that use
 * it come to their end.
 */
energywave_status energywave_renderer_free(struct energywave_renderer *renderer);

/**
 * Tells what the last frame cost. `cost` has its `struct_size` set.
 *
 * # Safety
 * `cost` points to as many bytes as it says.
 */
energywave_status energywave_renderer_cost(const struct energywave_renderer *renderer,
                                           struct energywave_cost *cost);

/**
 * Renders a scene into the caller's memory: linear RGBA in float32, by rows from the top left, which begin
 * `row_stride` bytes after each other (a multiple of 4; 0: no gap). What lies between rows stays as it is. The first
 * frame of each mix of sources builds kernels, for seconds. Where the call fails, the memory may hold a part of the
 * frame.
 *
 * # Safety
 * `rgba` points to `rgba_bytes` bytes.
 */
energywave_status energywave_render(struct energywave_renderer *renderer,
                                    const struct energywave_scene *scene,
                                    float *rgba,
                                    size_t rgba_bytes,
                                    size_t row_stride);

/**
 * Renders a scene in float64 by another method than the devices': the truth, hundreds of times slower, on all cores
 * and without OpenCL. The memory is as of energywave_render. Waves of particles and colliders are left out; a renderer
 * on `reference` draws them too.
 *
 * # Safety
 * As energywave_render.
 */
energywave_status energywave_reference(const struct energywave_scene *scene,
                                       float *rgba,
                                       size_t rgba_bytes,
                                       size_t row_stride);

/**
 * Integrates along single rays, from origins to ends, world units: `count` times three values each, x, y, z. `rgb`
 * gets linear red, green, blue of each, over the parameter or the length of the ray as the scene's measure says. The
 * scene's camera, image, depth and surfaces play no part.
 *
 * # Safety
 * `origins`, `ends` and `rgb` point to `3 * count` values each, and `rgb` overlaps neither.
 */
energywave_status energywave_integrate(struct energywave_renderer *renderer,
                                       const struct energywave_scene *scene,
                                       const double *origins,
                                       const double *ends,
                                       size_t count,
                                       double *rgb);

/**
 * Makes of light, linear RGBA in float32, a picture of 8-bit sRGB by the scene's display: bloom, exposure, tone
 * mapping, background. `channels` is 3, or 4 with a straight alpha, which is 255 unless the scene's display asks for
 * `alpha = "luminance"`. `has_bloom` is 1 if the renderer has spread it. Strides are bytes from row to row; 0: no gap.
 *
 * # Safety
 * `rgba` points to `rgba_bytes` bytes, `picture` to `picture_bytes`, and they do not overlap.
 */
energywave_status energywave_tone_map(const struct energywave_scene *scene,
                                      const float *rgba,
                                      size_t rgba_bytes,
                                      size_t rgba_row_stride,
                                      uint32_t has_bloom,
                                      uint8_t *picture,
                                      size_t picture_bytes,
                                      size_t picture_row_stride,
                                      uint32_t channels);

/**
 * Writes light, linear RGBA in float32, to a file: `.exr` as it is, `.png`, `.jpg` or `.webp` by the scene's display.
 * It is written to a temporary file and renamed. `has_bloom` is 1 if the renderer has spread it.
 *
 * # Safety
 * `rgba` points to `rgba_bytes` bytes; `path` ends with a 0.
 */
energywave_status energywave_save(const struct energywave_scene *scene,
                                  const float *rgba,
                                  size_t rgba_bytes,
                                  size_t rgba_row_stride,
                                  uint32_t has_bloom,
                                  const char *path);

/**
 * Enqueues a frame that is drawn into a host's buffer or image: the renderer is one of energywave_renderer_on_host.
 * The frame begins after the events and what is on the host's queue before it; what comes after it on an in-order
 * queue waits for it. Nothing here waits for the device, but for the compiler the first time that a scene needs other
 * kernels, and where surfaces meet the host's depths. With points this waits for what the frame waits for, and reads
 * them: when it comes back they may be written again. `*event` is the frame's end, a marker on the host's queue, which
 * the caller releases; `event` may be NULL.
 *
 * # Safety
 * `frame` points to as many bytes as it says, and its points to as many structs; all memory objects and events are
 * alive, or NULL; texts end with a 0. Until the event is over nothing else uses the target, and nothing writes the
 * depths. `event` is NULL, or points to a place for an event.
 */
energywave_status energywave_enqueue(struct energywave_renderer *renderer,
                                     const struct energywave_scene *scene,
                                     const struct energywave_frame *frame,
                                     struct _cl_event **event);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* ENERGYWAVE_H */
