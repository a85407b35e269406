// The block of rays that a work-item carries side by side: its columns and rows.
#pragma once
#include "lanes.h"

#if LANES == 16
#define BLOCK_COLUMNS 4u
#define BLOCK_ROWS 4u
#elif LANES == 8
#define BLOCK_COLUMNS 4u
#define BLOCK_ROWS 2u
#elif LANES == 4
#define BLOCK_COLUMNS 2u
#define BLOCK_ROWS 2u
#else
#define BLOCK_COLUMNS 1u
#define BLOCK_ROWS 1u
#endif
