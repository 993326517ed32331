/* Sparse Cholesky factorisations and fill-reducing orderings of C libraries, one process and one matrix at a time: CHOLMOD (and METIS
   through it), MUMPS, Scotch.

   Each is there if the build found it (FF_HAVE_...). All functions return 0, or one of the codes below. */
#if !defined(FETIFETI_DIRECT_H)
#define FETIFETI_DIRECT_H

/* This build has no such library. */
#define FF_ABSENT (-1)
/* A pivot is not positive, or too small; the column is known or -1. */
#define FF_NOT_POSITIVE 1
/* No memory, or more entries than the library's integers can count. */
#define FF_NO_MEMORY 2
/* Anything else; `why` has the library's own number. */
#define FF_FAILED 3

int ff_have_cholmod(void);
int ff_have_metis(void);
int ff_have_scotch(void);
int ff_have_mumps(void);

/* Whether several threads may call BLAS at once: all that we know of but OpenBLAS built for one thread. */
int ff_blas_takes_threads(void);

/* ---- orderings: order[k] is the vertex eliminated k-th; the graph is symmetric, without loops, in compressed rows ----
   Neither library may be called by two threads at once. */
int ff_metis_order(int n, const int *row, const int *col, int *order);
int ff_scotch_order(int n, const int *row, const int *col, int *order);

/* ---- CHOLMOD: LLᵀ of the matrix as it is ordered, given by its upper triangle in compressed columns with sorted rows ---- */
typedef struct ff_cholmod ff_cholmod;

int ff_cholmod_analyse(int n, const int *ptr, const int *row, int supernodal, ff_cholmod **out, int *why);
/* A factor of its own with this analysis; `column` is where a pivot was not positive. */
int ff_cholmod_factor(const ff_cholmod *analysis, const int *ptr, const int *row, const double *value, ff_cholmod **out, int *column, int *why);
/* b <- A^-1 b, `columns` vectors one after the other. This and the factorisation take as many threads as BLAS does. */
int ff_cholmod_solve(const ff_cholmod *factor, int columns, double *b, int *why);
/* The diagonal of L. */
void ff_cholmod_diagonal(const ff_cholmod *factor, double *diagonal);
/* The supernodes of L, lent: columns super[s]..super[s+1], rows s[pi[s]..pi[s+1]] (the pivots first), values by columns from x[px[s]].
   FF_FAILED for a simplicial factor. */
int ff_cholmod_supernodes(const ff_cholmod *factor, int *n, const int **super, const int **pi, const int **px, const int **s, const double **x);
double ff_cholmod_bytes(const ff_cholmod *factor);
void ff_cholmod_free(ff_cholmod *factor);

/* ---- MUMPS on this process alone: LDLᵀ without pivoting, entries (row, col) of one triangle counted from 1, in the order given ----
   The last `kept` unknowns are not eliminated. MPI must run. Never two threads at once. `row` and `col` must live as long as the object. */
typedef struct ff_mumps ff_mumps;

int ff_mumps_analyse(int n, int entries, const int *row, const int *col, int kept, ff_mumps **out, int *why);
/* `value` by entry; pivots below `small` count as zero; `schur` (kept x kept, by columns) takes the Schur complement. */
int ff_mumps_factor(ff_mumps *mumps, const double *value, double small, double *schur, int *column, int *why);
/* b <- A_II^-1 b on the eliminated unknowns, zero on the kept ones; `columns` vectors one after the other. */
int ff_mumps_solve(ff_mumps *mumps, int columns, double *b, int *why);
double ff_mumps_bytes(const ff_mumps *mumps);
void ff_mumps_free(ff_mumps *mumps);

#endif
