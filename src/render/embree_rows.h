// Every way to use Embree as a row, found by name like those of the table, but not in it: tables,
// tests and sessions have the row `embree` alone, and raybench versus finds out which of these is
// best where. Names say what differs from single rays in a tree of medium quality with spheres as
// user geometry:
//
//   embree-WAY[-native][-high][-avx2][-light]
//
// WAY: single, packet8, packet16, stream, and packet8c, packet16c, streamc, which tell Embree that
// rays are coherent. native: spheres are Embree's own. high: build quality, with spatial splits.
// avx2: Embree may use no more than that. light: shadow rays run from the light.
#ifndef RB_RENDER_EMBREE_ROWS_H
#define RB_RENDER_EMBREE_ROWS_H

#include "render/variants.h"

// Ended by a row without a name; empty in a build without libembree. Rows with the same tree follow
// each other.
extern const struct rb_variant rb_embree_rows[];

#endif
