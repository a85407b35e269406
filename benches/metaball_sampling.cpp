// The surface of metaballs (Mishima, Tanaka, Sagawa 2008) as one writes it first: a grid of cells of one radius in the
// world, samples every sixteenth of a radius along each ray, all of the 27 cells around each. The scene is that of
// `energywave bench --table 2008`: 65536 particles, jittered, 512x512, from near and from far.
//
// g++ -O3 -march=native -ffast-math -fopenmp benches/metaball_sampling.cpp -o plain && ./plain
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

struct Vec {
    float x, y, z;
};
static Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static Vec operator*(float k, Vec a) { return {k * a.x, k * a.y, k * a.z}; }
static float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Vec cross(Vec a, Vec b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
static Vec unit(Vec a) { return (1.0f / std::sqrt(dot(a, a))) * a; }

static const float H = 0.61f, THRESHOLD = 49.0f / 64.0f, SPACING = 0.45f;
static const int COUNT = 65536, COLUMNS = 24, SIZE = 512;

// Particles by cells.
struct Grid {
    Vec low;
    int size[3];
    std::vector<int> begin;
    std::vector<Vec> particles;

    int index(int x, int y, int z) const { return (z * size[1] + y) * size[0] + x; }
    int along(float place, float from) const { return int(std::floor((place - from) / H)); }
};

static Grid sorted(const std::vector<Vec> &points) {
    Grid grid;
    Vec low = points[0], high = points[0];
    for (Vec p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    grid.low = low + Vec{-H, -H, -H};
    const float span[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
    for (int axis = 0; axis < 3; ++axis)
        grid.size[axis] = int(span[axis] / H) + 4;
    auto cell = [&](Vec p) {
        return grid.index(grid.along(p.x, grid.low.x), grid.along(p.y, grid.low.y), grid.along(p.z, grid.low.z));
    };
    grid.begin.assign(grid.size[0] * grid.size[1] * grid.size[2] + 1, 0);
    for (Vec p : points)
        ++grid.begin[cell(p) + 1];
    for (size_t k = 1; k < grid.begin.size(); ++k)
        grid.begin[k] += grid.begin[k - 1];
    std::vector<int> at(grid.begin);
    grid.particles.resize(points.size());
    for (Vec p : points)
        grid.particles[at[cell(p)]++] = p;
    return grid;
}

static float field(const Grid &grid, Vec p) {
    const int x = grid.along(p.x, grid.low.x), y = grid.along(p.y, grid.low.y), z = grid.along(p.z, grid.low.z);
    float sum = 0.0f;
    for (int k = std::max(z - 1, 0); k <= std::min(z + 1, grid.size[2] - 1); ++k)
        for (int j = std::max(y - 1, 0); j <= std::min(y + 1, grid.size[1] - 1); ++j) {
            const int left = std::max(x - 1, 0), right = std::min(x + 1, grid.size[0] - 1);
            if (left > right)
                continue;
            for (int n = grid.begin[grid.index(left, j, k)]; n < grid.begin[grid.index(right, j, k) + 1]; ++n) {
                const Vec way = p + -1.0f * grid.particles[n];
                const float rest = std::max(1.0f - std::sqrt(dot(way, way)) / H, 0.0f);
                sum += rest * rest;
            }
        }
    return sum;
}

// Returns the length up to the surface; -1: none is there.
static float follow(const Grid &grid, Vec eye, Vec direction) {
    const float from[3] = {grid.low.x, grid.low.y, grid.low.z}, at[3] = {eye.x, eye.y, eye.z};
    const float along[3] = {direction.x, direction.y, direction.z};
    float enter = 0.0f, leave = 1e30f;
    for (int axis = 0; axis < 3; ++axis) {
        const float one = (from[axis] - at[axis]) / along[axis];
        const float other = (from[axis] + grid.size[axis] * H - at[axis]) / along[axis];
        enter = std::max(enter, std::min(one, other));
        leave = std::min(leave, std::max(one, other));
    }
    for (float s = enter; s < leave; s += H / 16.0f)
        if (field(grid, eye + s * direction) >= THRESHOLD)
            return s;
    return -1.0f;
}

int main() {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> shift(-0.25f, 0.25f);
    std::vector<Vec> points;
    const int layers = (COUNT + COLUMNS * COLUMNS - 1) / (COLUMNS * COLUMNS);
    for (int n = 0; n < COUNT; ++n) {
        const float middle = 0.5f * (COLUMNS - 1);
        const Vec cell = {n % COLUMNS - middle, n / COLUMNS % COLUMNS - middle,
                          n / (COLUMNS * COLUMNS) - 0.5f * (layers - 1)};
        points.push_back(SPACING * (cell + Vec{shift(random), shift(random), shift(random)}));
    }
    for (bool is_near : {false, true}) {
        const Vec toward_eye = unit({0.3f, -0.95f, 0.75f}), eye = (is_near ? 13.0f : 96.0f) * toward_eye;
        const Vec forward = -1.0f * toward_eye, right = unit(cross(forward, {0, 0, 1})), up = cross(right, forward);
        const float side = std::tan(15.0f * 3.14159265f / 180.0f);
        std::vector<float> lengths(SIZE * SIZE);
        std::vector<double> times;
        for (int round = 0; round < 5; ++round) {
            const auto begun = std::chrono::steady_clock::now();
            const Grid grid = sorted(points);
#pragma omp parallel for schedule(dynamic, 4)
            for (int row = 0; row < SIZE; ++row)
                for (int column = 0; column < SIZE; ++column) {
                    const float x = side * (2.0f * (column + 0.5f) / SIZE - 1.0f);
                    const float y = side * (1.0f - 2.0f * (row + 0.5f) / SIZE);
                    lengths[row * SIZE + column] = follow(grid, eye, unit(forward + x * right + y * up));
                }
            times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
        }
        std::sort(times.begin(), times.end());
        const auto hits = std::count_if(lengths.begin(), lengths.end(), [](float s) { return s >= 0.0f; });
        std::printf("%s: %.2f frames a second, the median of 5; %.1f %% of the rays hit\n", is_near ? "near" : "far",
                    1.0 / times[2], 100.0 * hits / lengths.size());
    }
}
