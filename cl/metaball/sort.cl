// Sorts particles into cells, anew for every frame: counts them, adds up where each cell begins, puts their numbers
// there, and sorts those of a cell. So the particles of a cell have one order, and sums over them one value, however
// the device shares out its work.
#include "cells.h"

// Cells that a work-item adds up.
#define CHUNK 256u

__kernel void clear_cells(__global uint *const restrict cells, const uint cell_count) {
    const uint begin = get_global_id(0) * CHUNK;
    for (uint cell = begin; cell < min(begin + CHUNK, cell_count); ++cell)
        cells[cell] = 0u;
}

// Counts the particles of a surface in each cell.
__kernel void count_particles(const Sight sight, __global const Surface *const restrict surfaces, const uint number,
                              __global const Slab *const restrict slabs, __global const Point *const restrict points,
                              __global uint *const restrict cell_of_point, __global uint *const restrict cells) {
    __global const Surface *const surface = surfaces + number;
    if (get_global_id(0) >= surface->point_count)
        return;
    const uint point = surface->first_point + get_global_id(0);
    const uint cell = cell_of(&sight, surface, slabs, seen_from_eye(&sight, surface, points + point));
    cell_of_point[point] = cell;
    if (cell != NO_CELL)
        atomic_inc(cells + cell);
}

// Adds up the cells of every chunk.
__kernel void sum_chunks(__global const uint *const restrict cells, const uint cell_count,
                         __global uint *const restrict sums) {
    const uint begin = get_global_id(0) * CHUNK;
    if (begin >= cell_count)
        return;
    uint sum = 0u;
    for (uint cell = begin; cell < min(begin + CHUNK, cell_count); ++cell)
        sum += cells[cell];
    sums[get_global_id(0)] = sum;
}

// Turns the sums of chunks into where they begin: by one work-item.
__kernel void begin_chunks(__global uint *const restrict sums, const uint cell_count) {
    if (get_global_id(0) > 0)
        return;
    uint begin = 0u;
    for (uint chunk = 0u; chunk < (cell_count + CHUNK - 1u) / CHUNK; ++chunk) {
        const uint count = sums[chunk];
        sums[chunk] = begin;
        begin += count;
    }
}

// Turns the numbers of particles in cells into where these begin.
__kernel void begin_cells(__global uint *const restrict cells, const uint cell_count,
                          __global const uint *const restrict sums) {
    const uint first = get_global_id(0) * CHUNK;
    if (first >= cell_count)
        return;
    uint begin = sums[get_global_id(0)];
    for (uint cell = first; cell < min(first + CHUNK, cell_count); ++cell) {
        const uint count = cells[cell];
        cells[cell] = begin;
        begin += count;
    }
}

// Puts the numbers of particles into their cells, in any order; then cells tell where they end.
__kernel void scatter_particles(__global const uint *const restrict cell_of_point, const uint point_count,
                                __global uint *const restrict cells, __global uint *const restrict order) {
    const uint point = get_global_id(0);
    if (point >= point_count || cell_of_point[point] == NO_CELL)
        return;
    order[atomic_inc(cells + cell_of_point[point])] = point;
}

// Up to so many numbers are sorted by insertion, more as a heap.
#define FEW 24u

void sort_few(__global uint *const numbers, const uint count) {
    for (uint next = 1u; next < count; ++next) {
        const uint number = numbers[next];
        uint place = next;
        for (; place > 0u && numbers[place - 1u] > number; --place)
            numbers[place] = numbers[place - 1u];
        numbers[place] = number;
    }
}

void sift_down(__global uint *const numbers, const uint root, const uint count) {
    const uint number = numbers[root];
    uint place = root;
    for (uint child = 2u * place + 1u; child < count; child = 2u * place + 1u) {
        child += child + 1u < count && numbers[child + 1u] > numbers[child];
        if (numbers[child] <= number)
            break;
        numbers[place] = numbers[child];
        place = child;
    }
    numbers[place] = number;
}

void sort_many(__global uint *const numbers, const uint count) {
    for (uint root = count / 2u; root > 0u; --root)
        sift_down(numbers, root - 1u, count);
    for (uint last = count - 1u; last > 0u; --last) {
        const uint greatest = numbers[0];
        numbers[0] = numbers[last];
        numbers[last] = greatest;
        sift_down(numbers, 0u, last);
    }
}

Particle particle_of(const Sight *const sight, __global const Surface *const surface,
                     __global const Point *const point) {
    const float3 place = seen_from_eye(sight, surface, point);
    const float radius = point->place.w, weight = point->rest.w;
    const float inverse_radius = 1.0f / radius, inverse2 = inverse_radius * inverse_radius;
    Particle particle;
    particle.x = place.x, particle.y = place.y, particle.z = place.z;
    particle.radius = radius;
    particle.inverse_radius = inverse_radius;
    particle.weight = weight;
    // With x = h^2 - d^2 the bound is w x / h^4, of the smooth kernel 3 w x^2 / h^6.
    particle.growth = weight * inverse2 * inverse2 * (surface->is_smooth ? 3.0f * inverse2 : 1.0f);
#ifdef HALF_GROWTH
    particle.growth *= 0.5f; // spoiled
#endif
    particle.padding = 0u;
    return particle;
}

// Sorts the cells of a chunk, and puts their particles side by side.
__kernel void sort_cells(const Sight sight, __global const Surface *const restrict surfaces, const uint surface_count,
                         __global const Point *const restrict points, __global const uint *const restrict cells,
                         const uint cell_count, __global uint *const restrict order,
                         __global Particle *const restrict particles, __global float *const restrict planes,
                         const uint plane) {
    const uint first = get_global_id(0) * CHUNK;
    uint number = 0u;
    for (uint cell = first; cell < min(first + CHUNK, cell_count); ++cell) {
        const uint begin = cell_begin(cells, cell), count = cells[cell] - begin;
        if (count > FEW)
            sort_many(order + begin, count);
        else
            sort_few(order + begin, count);
        for (uint place = begin; place < begin + count; ++place) {
            const uint point = order[place];
            while (point >= surfaces[number].first_point + surfaces[number].point_count)
                ++number; // cells and points have the order of their surfaces
            const Particle particle = particle_of(&sight, surfaces + number, points + point);
            particles[place] = particle;
            planes[place] = particle.x, planes[plane + place] = particle.y;
            planes[2u * plane + place] = particle.z;
            planes[3u * plane + place] = particle.radius * surfaces[number].wider;
        }
    }
}

// Finds the first slab that has particles near the rays of a square, and the one behind the last.
__kernel void find_slabs(const Sight sight, __global const Surface *const restrict surfaces, const uint number,
                         __global const Slab *const restrict slabs, __global const uint *const restrict cells,
                         __global uint2 *const restrict squares, const uint square_count) {
    const uint square = get_global_id(0);
    if (square >= square_count)
        return;
    __global const Surface *const surface = surfaces + number;
    const uint row = square / sight.span_columns, column = square - row * sight.span_columns;
    const Block block = block_of(&sight, sight.square * column, sight.square * row, sight.square, sight.square);
    uint2 found = (uint2)(surface->slab_count, 0u);
    for (uint at = 0u; at < surface->slab_count; ++at) {
        __global const Slab *const slab = slabs + surface->first_slab + at;
        const uint last = slab->first_cell + slab->columns * slab->rows - 1u;
        if (cells[last] == cell_begin(cells, slab->first_cell))
            continue;
        const Cells near = cells_near(slab, &block);
        bool has_any = false;
        for (uint line = near.top; line <= near.bottom && !has_any; ++line) {
            const uint begin = slab->first_cell + line * slab->columns;
            has_any = cells[begin + near.right] > cell_begin(cells, begin + near.left);
        }
        if (has_any)
            found = (uint2)(min(found.x, at), at + 1u);
    }
    squares[surface->first_square + square] = found;
}
