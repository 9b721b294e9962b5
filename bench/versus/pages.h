// On which pages memory lies. Our trees ask for huge ones (base/memory.h), Embree's are made by
// malloc, which does so only if it was told when the program started. For one policy on both sides
// the program starts again with GLIBC_TUNABLES=glibc.malloc.hugetlb=1 (glibc 2.35), which its
// workers inherit; and what came of it is measured.
#ifndef RB_VERSUS_PAGES_H
#define RB_VERSUS_PAGES_H

// Does not return if the program, whose path is `program`, starts again. Returns if it has, if the
// environment has tunables of the user's, or if it cannot be.
void rb_versus_restart(const char *program);

// Share of the memory of this process that is on huge pages, in per cent. NaN where Linux does not
// tell.
double rb_versus_huge_pct(void);

#endif
