/* Renders a scene file on the best device, and writes two pictures of it: PICTURE.ppm, tone-mapped to 8 bits in memory,
 * and PICTURE.png, by the library.
 *
 *   cc picture.c $(pkg-config --cflags --libs energywave) -o picture
 *   ./picture SCENE PICTURE [DEVICE [WIDTHxHEIGHT]]
 */
#include <energywave.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Says what went wrong, and where; returns whether something did. */
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

static int write_ppm(const char *path, const unsigned char *rgb, uint32_t width, uint32_t height) {
    FILE *const file = fopen(path, "wb");
    const size_t pixels = (size_t)width * height;
    if (file == NULL) {
        perror(path);
        return 1;
    }
    fprintf(file, "P6\n%u %u\n255\n", width, height);
    const int is_short = fwrite(rgb, 3, pixels, file) != pixels;
    return fclose(file) != 0 || is_short;
}

/* Draws the scene into memory of our own, and writes what is made of it. */
static int draw(energywave_renderer *renderer, const energywave_scene *scene, const char *picture) {
    energywave_scene_info info = {.struct_size = sizeof info};
    if (failed(energywave_scene_describe(scene, &info))) {
        return 1;
    }
    const size_t pixels = (size_t)info.width * info.height;
    const size_t light_bytes = pixels * 4 * sizeof(float);
    float *const light = malloc(light_bytes);
    unsigned char *const rgb = malloc(3 * pixels);
    char *const path = malloc(strlen(picture) + sizeof ".ppm");
    int is_bad = light == NULL || rgb == NULL || path == NULL;
    if (!is_bad) {
        is_bad = failed(energywave_render(renderer, scene, light, light_bytes, 0)) ||
                 failed(energywave_tone_map(scene, light, light_bytes, 0, 0, rgb, 3 * pixels, 0, 3)) ||
                 write_ppm(strcat(strcpy(path, picture), ".ppm"), rgb, info.width, info.height) ||
                 failed(energywave_save(scene, light, light_bytes, 0, 0, strcat(strcpy(path, picture), ".png")));
    }
    free(path);
    free(rgb);
    free(light);
    return is_bad;
}

int main(int argc, char **argv) {
    energywave_scene *scene = NULL;
    energywave_renderer *renderer = NULL;
    energywave_overrides overrides = {.struct_size = sizeof overrides};
    if (argc < 3) {
        fprintf(stderr, "usage: %s SCENE PICTURE [DEVICE [WIDTHxHEIGHT]]\n", argv[0]);
        return 2;
    }
    const char *const device = argc > 3 ? argv[3] : NULL;
    if (argc > 4 && sscanf(argv[4], "%ux%u", &overrides.width, &overrides.height) != 2) {
        fprintf(stderr, "%s: a size is such as 640x360\n", argv[4]);
        return 2;
    }
    const int is_bad = failed(energywave_check_abi(ENERGYWAVE_ABI)) || failed(energywave_suit_drivers()) ||
                       failed(energywave_scene_from_file(argv[1], &scene)) ||
                       failed(energywave_scene_override(scene, &overrides)) ||
                       failed(energywave_renderer_new(device, NULL, &renderer)) || draw(renderer, scene, argv[2]);
    energywave_renderer_free(renderer);
    energywave_scene_free(scene);
    return is_bad;
}
