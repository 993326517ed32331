/* Fill-reducing orderings by C libraries that usually come with PETSc: METIS (through CHOLMOD) and Scotch.

   Each is there if the build found it (FF_HAVE_...). The functions that order return 0, or one of the codes below. */
#if !defined(FETIFETI_ORDERING_H)
#define FETIFETI_ORDERING_H

/* This build has no such library. */
#define FF_ABSENT (-1)
/* No memory, or more entries than the library's integers can count. */
#define FF_NO_MEMORY 2
/* Anything else. */
#define FF_FAILED 3

int ff_have_metis(void);
int ff_have_scotch(void);

/* order[k] is the vertex eliminated k-th; the graph is symmetric, without loops, in compressed rows.
   Neither library may be called by two threads at once. */
int ff_metis_order(int n, const int *row, const int *col, int *order);
int ff_scotch_order(int n, const int *row, const int *col, int *order);

#endif
