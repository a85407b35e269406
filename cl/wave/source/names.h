// Names the functions and types of one kind in the text that all kinds share: where KIND is torus, KIND_field is
// torus_field. Beside this folder's README.md, this is the contract of a kind.
#pragma once
#include "../../lanes.h"

// What every kind has.
#define KIND_path JOIN(KIND, _path)
#define KIND_along JOIN(KIND, _along)
#define KIND_field JOIN(KIND, _field)
#define KIND_integral JOIN(KIND, _integral)
#define KIND_integral_of JOIN(KIND, _integral_of)
#define KIND_clearance JOIN(KIND, _clearance)
#define KIND_closest JOIN(KIND, _closest) // -D FOOTPRINT

// What a kind says of itself: #define curve_has_kinks 1. A kind that says nothing does not have it.
#define KIND_HAS(what) JOIN(KIND, _has_##what)

// What a kind without closed form has for the adaptive quadrature (../quadrature/adaptive.h).
#define KIND_peaks JOIN(KIND, _peaks)
#define KIND_peaks_along JOIN(KIND, _peaks_along)
#define KIND_panels JOIN(KIND, _panels)
#define KIND_near JOIN(KIND, _near)
#define KIND_approach JOIN(KIND, _approach)
#define KIND_near_field JOIN(KIND, _near_field)
#define KIND_edge_view JOIN(KIND, _edge_view) // -D SHAPES

// What it has in addition, if it says so.
#define KIND_look_ahead JOIN(KIND, _look_ahead) // KIND_HAS(look_ahead)
#define KIND_closed JOIN(KIND, _closed)         // KIND_HAS(closed_ends)
#define KIND_is_uneven JOIN(KIND, _is_uneven)   // KIND_HAS(dark_parts)
#define KIND_more_cuts JOIN(KIND, _more_cuts)   // KIND_HAS(more_cuts)
#define KIND_view JOIN(KIND, _view)             // KIND_HAS(jumps), with what follows
#define KIND_node_sight JOIN(KIND, _node_sight)
#define KIND_has_view JOIN(KIND, _has_view)
#define KIND_view_from JOIN(KIND, _view_from)
#define KIND_see JOIN(KIND, _see)
#define KIND_unseen JOIN(KIND, _unseen)
#define KIND_split JOIN(KIND, _split)

// What the templates make of that.
#define KIND_emission JOIN(KIND, _emission)     // ../radiance.h
#define KIND_simpson JOIN(KIND, _simpson)       // ../quadrature/simpson.h
#define KIND_add_to_row JOIN(KIND, _add_to_row) // ../cells.h
#define KIND_trim JOIN(KIND, _trim)
#define KIND_panel JOIN(KIND, _panel) // ../quadrature/adaptive.h, with what follows
#define KIND_open_panel JOIN(KIND, _open_panel)
#define KIND_sum_panel JOIN(KIND, _sum_panel)
#define KIND_halve JOIN(KIND, _halve)
#define KIND_two_panels JOIN(KIND, _two_panels)
#define KIND_at_end JOIN(KIND, _at_end) // ../tiles/settle.h
#define KIND_settle JOIN(KIND, _settle)
#define KIND_through JOIN(KIND, _through) // ../footprint/seen.h
#define KIND_seen JOIN(KIND, _seen)
