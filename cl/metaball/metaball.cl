// The kernels of the metaballs, in the order in which a frame has them: particles into cells, then rays to surfaces.
#include "draw.cl"
#include "sort.cl"
