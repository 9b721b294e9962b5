// Comes first in kernels that hold one ray against the 8 lanes of a node or a block: wider vectors,
// asked for with -DRB_LANES=16, would be half empty.
#ifndef RB_KERNELS_WIDE_LANES_H
#define RB_KERNELS_WIDE_LANES_H

#if defined(RB_LANES) && RB_LANES > 8
#undef RB_LANES
#define RB_LANES 8
#endif

#endif
