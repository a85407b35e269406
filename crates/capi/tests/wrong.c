/* What wrong arguments come back with: NULL, sizes, handles that were freed, other versions, values out of range. Needs
 * no device of OpenCL. */
#include "common.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#define OK ENERGYWAVE_STATUS_OK
#define ARGUMENT ENERGYWAVE_STATUS_BAD_ARGUMENT
#define HANDLE ENERGYWAVE_STATUS_BAD_HANDLE
#define VERSION ENERGYWAVE_STATUS_BAD_VERSION
#define SCENE ENERGYWAVE_STATUS_SCENE

static float light[VALUES];
static unsigned char picture[4 * WIDTH * HEIGHT];

static void versions(void) {
    struct {
        energywave_error error;
        size_t more;
    } newer = {.error = {.struct_size = sizeof newer}};
    energywave_error error = {0};
    fails(energywave_check_abi(ENERGYWAVE_ABI + 1), VERSION, "compile it again");
    fails(energywave_check_abi(0), VERSION, "abi");
    holds(energywave_last_error(NULL) == ARGUMENT, "last_error of NULL");
    holds(energywave_last_error(&error) == VERSION, "last_error of a size of 0");
    error.struct_size = sizeof error - 1;
    holds(energywave_last_error(&error) == VERSION, "last_error of a size too small");
    newer.more = 7;
    works(energywave_last_error(&newer.error), "last_error of a newer program");
    holds(newer.more == 7, "what is newer stays");
    holds(newer.error.struct_size == sizeof newer, "the size stays");
    holds(strcmp(newer.error.code, "bad-version") == 0, "the code of the last failure");
    holds(strcmp(last_error().remedy, "compile it again, or install the library that it was compiled for") == 0,
          "its remedy");
}

static void scenes(energywave_scene *scene) {
    energywave_scene *other = NULL;
    energywave_scene_info info = {0};
    char *text = NULL;
    fails(energywave_scene_from_file(NULL, &other), ARGUMENT, "path: NULL");
    fails(energywave_scene_from_file("missing.toml", NULL), ARGUMENT, "scene: NULL");
    fails(energywave_scene_from_file("missing.toml", &other), ENERGYWAVE_STATUS_INPUT, "missing.toml: cannot read");
    holds(strcmp(last_error().path, "missing.toml") == 0, "the path of an input");
    fails(energywave_scene_from_text(NULL, NULL, &other), ARGUMENT, "text: NULL");
    fails(energywave_scene_from_text("", NULL, &other), SCENE, "empty");
    fails(energywave_scene_from_text("\xff", NULL, &other), ARGUMENT, "no UTF-8 at byte 0");
    fails(energywave_scene_from_text("{ \"camera\": 1 }", NULL, &other), SCENE, "camera");
    fails(energywave_scene_from_text("[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[[torus]]\nmajor_radius = -1\n",
                                     NULL, &other),
          SCENE, "major_radius");
    holds(last_error().line == 5 && last_error().column > 0, "the place of a fault");
    holds(strcmp(last_error().key, "torus[0].major_radius") == 0, "the key of a fault");
    fails(energywave_scene_from_text("[camera]\neye = [0, -4, 2]\ntarget = [0, 0, 0]\n[depth]\nfile = \"z.exr\"\n",
                                     "no/folder", &other),
          SCENE, "no/folder/z.exr");
    holds(other == NULL, "a call that fails gives no scene");
    fails(energywave_scene_describe(NULL, &info), ARGUMENT, "scene: NULL");
    fails(energywave_scene_describe(scene, NULL), ARGUMENT, "info: NULL");
    fails(energywave_scene_describe(scene, &info), VERSION, "struct_size 0");
    info.struct_size = (size_t)-1;
    fails(energywave_scene_describe(scene, &info), VERSION, "struct_size");
    fails(energywave_scene_warnings(scene, NULL), ARGUMENT, "text: NULL");
    fails(energywave_scene_warnings(NULL, &text), ARGUMENT, "scene: NULL");
    fails(energywave_scene_set_time(scene, (double)NAN), SCENE, "no time");
    fails(energywave_scene_set_time(NULL, 1.0), ARGUMENT, "scene: NULL");
}

static void overrides(energywave_scene *scene) {
    struct {
        energywave_overrides known;
        size_t more;
    } newer = {.known = {.struct_size = sizeof newer, .width = WIDTH, .height = HEIGHT}, .more = 0};
    energywave_overrides given = {0};
    energywave_scene_info info = {.struct_size = sizeof info};
    fails(energywave_scene_override(scene, &given), VERSION, "struct_size 0");
    given.struct_size = sizeof given;
    given.width = 7;
    fails(energywave_scene_override(scene, &given), ARGUMENT, "7x0 pixels");
    given.height = 1u << 20;
    fails(energywave_scene_override(scene, &given), SCENE, "16384");
    given.height = given.width = 0;
    given.method = "guess";
    fails(energywave_scene_override(scene, &given), ARGUMENT, "\"guess\" is none; use exact, simpson, jittered");
    given.method = "simpson";
    given.sampling = "tiles";
    fails(energywave_scene_override(scene, &given), SCENE, "\"simpson\" takes every pixel");
    holds(strcmp(last_error().key, "integration.sampling") == 0, "the key of tiles");
    given.sampling = NULL;
    given.divisions = 3;
    fails(energywave_scene_override(scene, &given), SCENE, "divisions");
    given.method = NULL;
    given.divisions = 0;
    given.tolerance = -1.0;
    fails(energywave_scene_override(scene, &given), SCENE, "tolerance");
    given.tolerance = 0.0;
    given.antialias = "\xc0";
    fails(energywave_scene_override(scene, &given), ARGUMENT, "no UTF-8");
    works(energywave_scene_override(scene, &newer.known), "overrides of a newer program that asks for nothing new");
    newer.more = 1;
    fails(energywave_scene_override(scene, &newer.known), VERSION, "not 0");
    works(energywave_scene_describe(scene, &info), "the scene is still there");
    holds(info.width == WIDTH && info.height == HEIGHT, "the scene is as it was");
}

static void renderers(energywave_renderer *renderer, energywave_scene *scene) {
    energywave_renderer *other = NULL;
    energywave_options options = {.struct_size = sizeof options, .lanes = 3};
    energywave_cost cost = {0};
    energywave_device device = {0};
    const double rays[6] = {0};
    double rgb[6];
    fails(energywave_renderer_new("reference", NULL, NULL), ARGUMENT, "renderer: NULL");
    fails(energywave_renderer_new("no such thing", NULL, &other), ENERGYWAVE_STATUS_NO_SUCH_DEVICE, "no such thing");
    fails(energywave_renderer_new("reference,reference", NULL, &other), ENERGYWAVE_STATUS_NO_SUCH_DEVICE, "twice");
    options.lanes = 0;
    options.spreads_bloom = 2;
    fails(energywave_renderer_new("reference", &options, &other), ARGUMENT, "options.spreads_bloom: 2");
    options.kernel_cache = 3;
    fails(energywave_renderer_new("reference", &options, &other), ARGUMENT, "options.kernel_cache: 3");
    fails(energywave_renderer_on_host(NULL, NULL, NULL, &other), ENERGYWAVE_STATUS_HOST, "null");
    holds(other == NULL, "a call that fails gives no renderer");
    fails(energywave_renderer_cost(renderer, &cost), VERSION, "struct_size 0");
    fails(energywave_renderer_cost(NULL, &cost), ARGUMENT, "renderer: NULL");
    fails(energywave_device_describe("reference", &device), VERSION, "struct_size 0");
    fails(energywave_device_describe("", &device), ENERGYWAVE_STATUS_NO_SUCH_DEVICE, "no device");
    fails(energywave_devices(NULL), ARGUMENT, "json: NULL");

    fails(energywave_render(renderer, scene, NULL, sizeof light, 0), ARGUMENT, "rgba: NULL");
    fails(energywave_render(renderer, scene, light, sizeof light - 1, 0), ARGUMENT, "12x8 pixels");
    fails(energywave_render(renderer, scene, light, sizeof light, 16 * WIDTH - 4), ARGUMENT, "row_stride of 188 bytes");
    fails(energywave_render(renderer, scene, light, sizeof light, 16 * WIDTH + 2), ARGUMENT, "multiple of 4");
    fails(energywave_render(renderer, scene, light, sizeof light, 16 * WIDTH + 4), ARGUMENT, "need");
    fails(energywave_render(renderer, scene, light, sizeof light, SIZE_MAX & ~(size_t)3), ARGUMENT, "need");
    fails(energywave_render(renderer, scene, (float *)((char *)light + 1), sizeof light, 0), ARGUMENT, "multiple of 4");
    fails(energywave_reference(scene, light, 0, 0), ARGUMENT, "0 bytes");
    fails(energywave_integrate(renderer, scene, rays, NULL, 2, rgb), ARGUMENT, "ends: NULL");
    fails(energywave_integrate(renderer, scene, rays, rays, SIZE_MAX, rgb), ARGUMENT, "count");
    fails(energywave_integrate(renderer, scene, rays, rays, SIZE_MAX / 4, rgb), ARGUMENT, "more bytes");
    fails(energywave_integrate(renderer, scene, rays, rays, 2, rgb), SCENE, "ray 0");
    fails(energywave_enqueue(renderer, scene, NULL, NULL), ARGUMENT, "frame: NULL");
    energywave_frame frame = {.struct_size = sizeof frame};
    fails(energywave_enqueue(renderer, scene, &frame, NULL), ARGUMENT, "frame.target_kind: 0");
    frame.target_kind = ENERGYWAVE_BUFFER;
    frame.wait_count = 2;
    fails(energywave_enqueue(renderer, scene, &frame, NULL), ARGUMENT, "frame.wait_list: NULL");
    frame.wait_count = 0;
    fails(energywave_enqueue(renderer, scene, &frame, NULL), ENERGYWAVE_STATUS_HOST, "without");
}

/* Rays that are none: which, and which coordinate of which end. */
static void rays(energywave_renderer *renderer, energywave_scene *scene) {
    double begins[6] = {0}, ends[6] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0}, rgb[6];
    begins[4] = (double)NAN;
    fails(energywave_integrate(renderer, scene, begins, ends, 2, rgb), SCENE, "ray 1: start: y is NaN");
    holds(strcmp(last_error().key, "ray 1") == 0, "the key of a ray");
    begins[4] = 0.0;
    ends[0] = -(double)INFINITY;
    fails(energywave_integrate(renderer, scene, begins, ends, 2, rgb), SCENE, "ray 0: end: x is -inf; coordinates are");
    ends[0] = 2e9;
    fails(energywave_integrate(renderer, scene, begins, ends, 2, rgb), SCENE, "ray 0: end: x is 2e9; float32");
    ends[0] = 0.0;
    fails(energywave_integrate(NULL, scene, begins, ends, 2, rgb), ARGUMENT, "renderer: NULL");
    fails(energywave_integrate(renderer, NULL, begins, ends, 2, rgb), ARGUMENT, "scene: NULL");
    fails(energywave_integrate(renderer, scene, begins, ends, 2, NULL), ARGUMENT, "rgb: NULL");
    fails(energywave_integrate(renderer, scene, (double *)((char *)begins + 4), ends, 1, rgb), ARGUMENT, "origins: it");
    works(energywave_integrate(renderer, scene, NULL, NULL, 0, NULL), "no rays");
    works(energywave_integrate(renderer, scene, begins, ends, 2, rgb), "the rays are mended");
}

/* Choices of devices and of a scene's values that are nearly right. */
static void choices(energywave_scene *scene) {
    const char *const devices[] = {"", ",", " ", "99", "-1", "reference,none", "cpu.", "all,all"};
    const struct {
        energywave_overrides given;
        energywave_status expected;
        const char *words;
    } overrides[] = {
        {{.reserved = 1}, ARGUMENT, "overrides.reserved: 1; it must be 0"},
        {{.method = ""}, ARGUMENT, "overrides.method: \"\" is none"},
        {{.method = "Exact"}, ARGUMENT, "use exact, simpson, jittered"},
        {{.sampling = "tile"}, ARGUMENT, "overrides.sampling: \"tile\" is none; use tiles, pixels"},
        {{.antialias = "msaa"}, ARGUMENT, "use footprint, none"},
        {{.tolerance = (double)NAN}, SCENE, "tolerance: NaN"},
        {{.tolerance = (double)INFINITY}, SCENE, "tolerance: inf"},
        {{.divisions = 100000}, SCENE, "from 2 to 65536"},
        {{.width = 16385, .height = 1}, SCENE, "at most 16384"},
        {{.width = UINT32_MAX, .height = UINT32_MAX}, SCENE, "at most 16384"},
    };
    energywave_renderer *renderer = NULL;
    for (size_t i = 0; i < sizeof devices / sizeof *devices; i++) {
        fails(energywave_renderer_new(devices[i], NULL, &renderer), ENERGYWAVE_STATUS_NO_SUCH_DEVICE, "device");
        holds(*last_error().remedy != 0 && strchr(last_error().remedy, '\n') == NULL, "what to do about a device");
    }
    holds(renderer == NULL, "no renderer");
    for (size_t i = 0; i < sizeof overrides / sizeof *overrides; i++) {
        energywave_overrides given = overrides[i].given;
        given.struct_size = sizeof given;
        fails(energywave_scene_override(scene, &given), overrides[i].expected, overrides[i].words);
    }
}

static void files(energywave_scene *scene) {
    energywave_scene *other = NULL;
    fails(energywave_scene_from_file("", &other), ARGUMENT, "path: it is empty");
    fails(energywave_scene_from_file("/", &other), ENERGYWAVE_STATUS_INPUT, "/: cannot read");
    holds(*last_error().remedy != 0, "what to do about a file");
    fails(energywave_scene_from_text("x", NULL, &other), SCENE, "scene:1:2");
    fails(energywave_scene_from_text("{", NULL, &other), SCENE, "scene:1:1");
    fails(energywave_scene_from_text("{\"camera\": {}}", NULL, &other), SCENE, "camera");
    fails(energywave_save(scene, light, sizeof light, 0, 0, ""), ARGUMENT, "path: it is empty");
    fails(energywave_save(NULL, light, sizeof light, 0, 0, "light.png"), ARGUMENT, "scene: NULL");
    holds(other == NULL, "no scene");
}

static void pictures(energywave_scene *scene) {
    const size_t bytes = sizeof light;
    fails(energywave_tone_map(NULL, light, bytes, 0, 0, picture, sizeof picture, 0, 4), ARGUMENT, "scene: NULL");
    fails(energywave_tone_map(scene, NULL, bytes, 0, 0, picture, sizeof picture, 0, 4), ARGUMENT, "rgba: NULL");
    fails(energywave_tone_map(scene, light, bytes, 0, 0, NULL, sizeof picture, 0, 4), ARGUMENT, "picture: NULL");
    fails(energywave_tone_map(scene, light, bytes, 0, 0, picture, 7, 0, 4), ARGUMENT, "picture: 7 bytes");
    fails(energywave_tone_map(scene, light, 16, 0, 0, picture, sizeof picture, 0, 4), ARGUMENT, "rgba: 16 bytes");
    fails(energywave_tone_map(scene, light, bytes, 0, 0, picture, sizeof picture, 0, 1), ARGUMENT, "channels: 1");
    fails(energywave_tone_map(scene, light, bytes, 0, 9, picture, sizeof picture, 0, 4), ARGUMENT, "has_bloom: 9");
    fails(energywave_save(scene, light, bytes, 0, 0, NULL), ARGUMENT, "path: NULL");
    fails(energywave_save(scene, light, bytes, 0, 0, "picture.tga"), ENERGYWAVE_STATUS_OUTPUT_FORMAT, "picture.tga");
    fails(energywave_save(scene, light, bytes, 0, 0, "no/folder/picture.png"), ENERGYWAVE_STATUS_OUTPUT, "no/folder");
}

/* Numbers, addresses, other kinds and what was freed: none is looked behind. */
static void handles(energywave_renderer *renderer, energywave_scene *scene) {
    int foreign[4] = {0};
    char *const own = malloc(8);
    energywave_scene *copy = NULL;
    energywave_renderer *reference = NULL;
    char *json = NULL;
    const size_t bytes = sizeof light;
    fails(energywave_render((energywave_renderer *)foreign, scene, light, bytes, 0), HANDLE, "renderer: it was freed");
    fails(energywave_render(renderer, (energywave_scene *)(uintptr_t)0xdead, light, bytes, 0), HANDLE, "scene: ");
    fails(energywave_render((energywave_renderer *)scene, scene, light, bytes, 0), HANDLE, "it is a scene");
    fails(energywave_scene_free((energywave_scene *)renderer), HANDLE, "it is a renderer");
    works(energywave_scene_from_text(SMALL, NULL, &copy), "another scene");
    works(energywave_scene_free(copy), "it is freed");
    fails(energywave_scene_free(copy), HANDLE, "it was freed");
    fails(energywave_scene_set_time(copy, 1.0), HANDLE, "it was freed");
    fails(energywave_render(renderer, copy, light, bytes, 0), HANDLE, "it was freed");
    works(energywave_renderer_new("reference", NULL, &reference), "another renderer");
    works(energywave_renderer_free(reference), "it is freed");
    fails(energywave_renderer_free(reference), HANDLE, "it was freed");
    fails(energywave_render(reference, scene, light, bytes, 0), HANDLE, "it was freed");
    works(energywave_devices(&json), "a text");
    fails(energywave_text_free(own), HANDLE, "text: ");
    fails(energywave_text_free(json + 1), HANDLE, "text: ");
    works(energywave_text_free(json), "the text is freed");
    fails(energywave_text_free(json), HANDLE, "text: ");
    works(energywave_scene_free(NULL), "NULL is no scene");
    works(energywave_renderer_free(NULL), "NULL is no renderer");
    works(energywave_text_free(NULL), "NULL is no text");
    free(own);
}

int main(void) {
    energywave_scene *scene = NULL;
    energywave_renderer *renderer = NULL;
    holds(last_error().status == OK && *last_error().message == 0, "nothing has failed yet");
    works(energywave_scene_from_text(SMALL, NULL, &scene), "a scene");
    works(energywave_renderer_new("reference", NULL, &renderer), "a renderer");
    versions();
    scenes(scene);
    overrides(scene);
    renderers(renderer, scene);
    rays(renderer, scene);
    choices(scene);
    files(scene);
    pictures(scene);
    handles(renderer, scene);
    works(energywave_renderer_free(renderer), "the renderer is freed");
    works(energywave_scene_free(scene), "the scene is freed");
    return finish("wrong");
}
