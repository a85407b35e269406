// Stops the build where a struct that crosses from the host to the device has another size on either side. The host
// passes each size as -D SIZEOF_X; src/wave/pack/ and src/opencl/film.rs mirror the structs. They hold 32-bit scalars
// and vectors of four of them, so that both sides lay them out alike.
#pragma once

#define CHECK_SIZE(type, size) typedef char type##_has_the_size_that_the_host_expects[sizeof(type) == (size) ? 1 : -1]
