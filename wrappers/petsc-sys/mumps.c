/* MUMPS on MPI_COMM_SELF. */
#include "direct.h"

#if defined(FF_HAVE_MUMPS)
  #include <dmumps_c.h>
  #include <mpi.h>
  #include <stdlib.h>
  #include <string.h>

struct ff_mumps {
  DMUMPS_STRUC_C id;
  int            kept;
  int           *kept_list, *order;
};

  /* As in MUMPS's guide. */
  #define ICNTL(i) icntl[(i) - 1]
  #define CNTL(i)  cntl[(i) - 1]
  #define INFOG(i) infog[(i) - 1]

enum {
  JOB_BEGIN   = -1,
  JOB_END     = -2,
  JOB_ANALYSE = 1,
  JOB_FACTOR  = 2,
  JOB_SOLVE   = 3,
  SYMMETRIC   = 2 /* indefinite ones allowed: only then are negative pivots counted and small ones found */
};

extern int  omp_get_max_active_levels(void) __attribute__((weak));
extern void omp_set_max_active_levels(int) __attribute__((weak));

/* Runs one phase on one thread, whatever OpenMP was told. */
static int run(DMUMPS_STRUC_C *id, int job, int *why)
{
  const int threads = omp_get_max_active_levels && omp_set_max_active_levels;
  const int levels  = threads ? omp_get_max_active_levels() : 0;

  if (threads) omp_set_max_active_levels(0);
  id->job = job;
  dmumps_c(id);
  if (threads) omp_set_max_active_levels(levels);
  *why = id->INFOG(1);
  if (id->INFOG(1) >= 0) return 0;
  switch (id->INFOG(1)) {
  case -10:
  case -40:
    return FF_NOT_POSITIVE;
  case -7:
  case -8:
  case -9:
  case -13:
  case -19:
  case -51:
  case -52:
    return FF_NO_MEMORY;
  default:
    return FF_FAILED;
  }
}

int ff_have_mumps(void)
{
  return sizeof(MUMPS_INT) == sizeof(int);
}

int ff_mumps_analyse(int n, int entries, const int *row, const int *col, int kept, ff_mumps **out, int *why)
{
  ff_mumps *m;
  int       running = 0, ended = 0, result;

  *why = 0;
  if (!ff_have_mumps()) return FF_ABSENT;
  MPI_Initialized(&running);
  MPI_Finalized(&ended);
  if (!running || ended) return FF_FAILED;
  m = calloc(1, sizeof(*m));
  if (!m) return FF_NO_MEMORY;
  m->id.sym          = SYMMETRIC;
  m->id.par          = 1;
  m->id.comm_fortran = (MUMPS_INT)MPI_Comm_c2f(MPI_COMM_SELF);
  result             = run(&m->id, JOB_BEGIN, why);
  if (result) {
    free(m);
    return result;
  }
  m->kept      = kept;
  m->kept_list = malloc(((size_t)kept + 1) * sizeof(int));
  m->order     = malloc(((size_t)n + 1) * sizeof(int));
  if (!m->kept_list || !m->order) {
    ff_mumps_free(m);
    return FF_NO_MEMORY;
  }
  for (int k = 1; k <= 4; k++) m->id.ICNTL(k) = k == 4 ? 0 : -1; /* silence */
  m->id.ICNTL(6)  = 0;                                           /* no permutation for the diagonal, */
  m->id.ICNTL(7)  = 1;                                           /* the order given, */
  m->id.ICNTL(8)  = 0;                                           /* no scaling: ours has been applied, */
  m->id.ICNTL(10) = 0;                                           /* no refinement, */
  m->id.ICNTL(12) = 1;                                           /* no compressed pairs of pivots, */
  m->id.ICNTL(13) = 1;                                           /* no ScaLAPACK at the root, */
  m->id.ICNTL(24) = 1;                                           /* small pivots are counted, */
  m->id.ICNTL(28) = 1;                                           /* sequential analysis */
  m->id.CNTL(1)   = 0.0;                                         /* and no pivoting */
  m->id.n         = n;
  m->id.nnz       = entries;
  m->id.irn       = (MUMPS_INT *)row;
  m->id.jcn       = (MUMPS_INT *)col;
  for (int i = 0; i < n; i++) m->order[i] = i + 1;
  m->id.perm_in = m->order;
  if (kept > 0) {
    for (int i = 0; i < kept; i++) m->kept_list[i] = n - kept + i + 1;
    m->id.ICNTL(19)     = 3; /* the Schur complement with both triangles, by columns */
    m->id.size_schur    = kept;
    m->id.listvar_schur = m->kept_list;
    m->id.nprow = m->id.npcol = 1;
    m->id.mblock = m->id.nblock = 100;
  }
  result = run(&m->id, JOB_ANALYSE, why);
  if (result) {
    ff_mumps_free(m);
    return result;
  }
  *out = m;
  return 0;
}

int ff_mumps_factor(ff_mumps *m, const double *value, double small, double *schur, int *column, int *why)
{
  int result;

  *column       = -1;
  m->id.a       = (double *)value;
  m->id.CNTL(3) = -small; /* negative: absolute */
  if (m->kept > 0) {
    m->id.schur     = schur;
    m->id.schur_lld = m->kept;
  }
  /* More room until it suffices: the estimate of the analysis knows nothing of delayed pivots. */
  for (m->id.ICNTL(14) = 20;; m->id.ICNTL(14) *= 4) {
    result = run(&m->id, JOB_FACTOR, why);
    if (m->id.ICNTL(14) > 1000 || (*why != -8 && *why != -9)) break;
  }
  m->id.a = NULL;
  if (result) return result;
  if (m->id.INFOG(28) > 0) {
    if (m->id.pivnul_list) *column = m->id.pivnul_list[0] - 1;
    return FF_NOT_POSITIVE;
  }
  return m->id.INFOG(12) > 0 ? FF_NOT_POSITIVE : 0;
}

int ff_mumps_solve(ff_mumps *m, int columns, double *b, int *why)
{
  int result;

  m->id.rhs       = b;
  m->id.nrhs      = columns;
  m->id.lrhs      = m->id.n;
  m->id.ICNTL(26) = 0;
  m->id.ICNTL(27) = columns; /* all at once */
  result          = run(&m->id, JOB_SOLVE, why);
  m->id.rhs       = NULL;
  return result;
}

double ff_mumps_bytes(const ff_mumps *m)
{
  const double entries = m->id.INFOG(29) < 0 ? -1e6 * m->id.INFOG(29) : m->id.INFOG(29);

  return 8.0 * entries;
}

void ff_mumps_free(ff_mumps *m)
{
  int ended = 0, why;

  if (!m) return;
  MPI_Finalized(&ended);
  /* MUMPS frees its communicator, which is gone with MPI. */
  if (!ended) run(&m->id, JOB_END, &why);
  free(m->kept_list);
  free(m->order);
  free(m);
}

#else

int ff_have_mumps(void)
{
  return 0;
}
int ff_mumps_analyse(int n, int entries, const int *row, const int *col, int kept, ff_mumps **out, int *why)
{
  return FF_ABSENT;
}
int ff_mumps_factor(ff_mumps *mumps, const double *value, double small, double *schur, int *column, int *why)
{
  return FF_ABSENT;
}
int ff_mumps_solve(ff_mumps *mumps, int columns, double *b, int *why)
{
  return FF_ABSENT;
}
double ff_mumps_bytes(const ff_mumps *mumps)
{
  return 0;
}
void ff_mumps_free(ff_mumps *mumps) { }
#endif
