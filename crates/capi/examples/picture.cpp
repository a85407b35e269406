// The same in C++: handles that free themselves, and failures that are thrown.
//
//   c++ -std=c++17 picture.cpp $(pkg-config --cflags --libs energywave) -o picture
//   ./picture PICTURE.png [DEVICE]
#include <energywave.h>

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace energywave {

// A failure, with its message.
class Error : public std::runtime_error {
  public:
    explicit Error(const energywave_error &error)
        : std::runtime_error(error.message), status(error.status), line(error.line), key(error.key) {
    }

    energywave_status status;
    unsigned line;   // in the scene's text; 0: not known
    std::string key; // in the scene; empty: not known
};

inline void check(energywave_status status) {
    if (status != ENERGYWAVE_STATUS_OK) {
        energywave_error error{};
        error.struct_size = sizeof error;
        energywave_last_error(&error);
        throw Error(error);
    }
}

template <typename Handle, energywave_status (*Free)(Handle *)> struct Freed {
    void operator()(Handle *handle) const noexcept {
        Free(handle);
    }
};

template <typename Handle, energywave_status (*Free)(Handle *)>
using Owned = std::unique_ptr<Handle, Freed<Handle, Free>>;

using Scene = Owned<energywave_scene, energywave_scene_free>;
using Renderer = Owned<energywave_renderer, energywave_renderer_free>;
using Text = Owned<char, energywave_text_free>;

inline Scene scene_from_text(const std::string &text) {
    energywave_scene *scene = nullptr;
    check(energywave_scene_from_text(text.c_str(), nullptr, &scene));
    return Scene(scene);
}

inline Renderer open(const char *device) {
    energywave_renderer *renderer = nullptr;
    check(energywave_renderer_new(device, nullptr, &renderer));
    return Renderer(renderer);
}

inline Text devices() {
    char *json = nullptr;
    check(energywave_devices(&json));
    return Text(json);
}

// Light of a scene: four values a pixel, by rows from the top left.
inline std::vector<float> render(const Renderer &renderer, const Scene &scene) {
    energywave_scene_info info{};
    info.struct_size = sizeof info;
    check(energywave_scene_describe(scene.get(), &info));
    std::vector<float> light(std::size_t{4} * info.width * info.height);
    check(energywave_render(renderer.get(), scene.get(), light.data(), light.size() * sizeof(float), 0));
    return light;
}

} // namespace energywave

int main(int argc, char **argv) try {
    if (argc < 2) {
        std::fprintf(stderr, "usage: %s PICTURE.png [DEVICE]\n", argv[0]);
        return 2;
    }
    energywave::check(energywave_check_abi(ENERGYWAVE_ABI));
    std::puts(energywave::devices().get());
    const auto scene = energywave::scene_from_text(R"(
        [camera]
        eye = [0, -4, 2]
        target = [0, 0, 0]
        [image]
        width = 96
        height = 64
        [[torus]]
        color = [0.15, 0.35, 1.0]
        coefficient = 0.01
        major_radius = 0.9
    )");
    const auto renderer = energywave::open(argc > 2 ? argv[2] : nullptr);
    const auto light = energywave::render(renderer, scene);
    energywave::check(energywave_save(scene.get(), light.data(), light.size() * sizeof(float), 0, 0, argv[1]));
    return 0;
} catch (const energywave::Error &error) {
    std::fprintf(stderr, "error %d: %s\n", static_cast<int>(error.status), error.what());
    return 1;
}
