/* CHOLMOD, and METIS through it. */
#include "direct.h"
#include <stdlib.h>
#include <string.h>

#if defined(FF_HAVE_CHOLMOD)
  #if __has_include(<suitesparse/cholmod.h>)
    #include <suitesparse/cholmod.h>
  #else
    #include <cholmod.h>
  #endif

struct ff_cholmod {
  cholmod_factor *l;
  size_t          entries; /* of the matrix */
};

/* Debian's CHOLMOD asks OpenMP for four threads by number, which only this overrules; without OpenMP the functions are not there. */
extern int  omp_get_max_active_levels(void) __attribute__((weak));
extern void omp_set_max_active_levels(int) __attribute__((weak));

static int one_thread(void)
{
  int before = 1;
  if (omp_get_max_active_levels && omp_set_max_active_levels) {
    before = omp_get_max_active_levels();
    omp_set_max_active_levels(0);
  }
  return before;
}

static void as_before(int levels)
{
  if (omp_get_max_active_levels && omp_set_max_active_levels) omp_set_max_active_levels(levels);
}

static void start(cholmod_common *c, int supernodal)
{
  cholmod_start(c);
  c->print              = 0;
  c->nmethods           = 1;
  c->method[0].ordering = CHOLMOD_NATURAL; /* the matrix comes ordered */
  c->postorder          = 0;
  c->final_ll           = 1;
  c->supernodal         = supernodal ? CHOLMOD_SUPERNODAL : CHOLMOD_AUTO;
  c->quick_return_if_not_posdef = 1;
}

static int code(const cholmod_common *c, int *why)
{
  *why = c->status;
  if (c->status == CHOLMOD_OK || c->status == CHOLMOD_DSMALL) return 0;
  if (c->status == CHOLMOD_NOT_POSDEF) return FF_NOT_POSITIVE;
  if (c->status == CHOLMOD_OUT_OF_MEMORY || c->status == CHOLMOD_TOO_LARGE) return FF_NO_MEMORY;
  return FF_FAILED;
}

/* A header over arrays of ours; CHOLMOD does not write to what it gets as input. */
static cholmod_sparse upper(int n, const int *ptr, const int *row, const double *value)
{
  cholmod_sparse a;
  memset(&a, 0, sizeof(a));
  a.nrow = a.ncol = (size_t)n;
  a.nzmax         = (size_t)ptr[n];
  a.p             = (void *)ptr;
  a.i             = (void *)row;
  a.x             = (void *)value;
  a.stype         = 1;
  a.itype         = CHOLMOD_INT;
  a.xtype         = value ? CHOLMOD_REAL : CHOLMOD_PATTERN;
  a.dtype         = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;
  return a;
}

int ff_have_cholmod(void)
{
  return 1;
}

int ff_cholmod_analyse(int n, const int *ptr, const int *row, int supernodal, ff_cholmod **out, int *why)
{
  cholmod_common  c;
  cholmod_sparse  a = upper(n, ptr, row, NULL);
  cholmod_factor *l;
  int             result;

  start(&c, supernodal);
  l      = cholmod_analyze(&a, &c);
  result = code(&c, why);
  if (l && !result) {
    *out = malloc(sizeof(**out));
    if (*out) {
      (*out)->l       = l;
      (*out)->entries = (size_t)ptr[n];
      l               = NULL;
    } else result = FF_NO_MEMORY;
  } else if (!result) result = FF_FAILED;
  if (l) cholmod_free_factor(&l, &c);
  cholmod_finish(&c);
  return result;
}

int ff_cholmod_factor(const ff_cholmod *analysis, const int *ptr, const int *row, const double *value, ff_cholmod **out, int *column, int *why)
{
  cholmod_common  c;
  cholmod_sparse  a = upper((int)analysis->l->n, ptr, row, value);
  cholmod_factor *l;
  int             result, levels = one_thread();

  *column = -1;
  start(&c, analysis->l->is_super);
  l      = cholmod_copy_factor(analysis->l, &c);
  result = code(&c, why);
  if (l && !result) {
    cholmod_factorize(&a, l, &c);
    result = code(&c, why);
    if (!result && l->minor < l->n) result = FF_NOT_POSITIVE;
    if (result == FF_NOT_POSITIVE) *column = (int)l->minor;
  } else if (!result) result = FF_NO_MEMORY;
  if (!result) {
    *out = malloc(sizeof(**out));
    if (*out) {
      (*out)->l       = l;
      (*out)->entries = analysis->entries;
      l               = NULL;
    } else result = FF_NO_MEMORY;
  }
  if (l) cholmod_free_factor(&l, &c);
  cholmod_finish(&c);
  as_before(levels);
  return result;
}

int ff_cholmod_solve(const ff_cholmod *factor, int columns, double *b, int *why)
{
  cholmod_common c;
  cholmod_dense  right, *x;
  int            result, levels = one_thread();
  const size_t   n = factor->l->n;

  start(&c, factor->l->is_super);
  memset(&right, 0, sizeof(right));
  right.nrow = right.d = n;
  right.ncol           = (size_t)columns;
  right.nzmax          = n * (size_t)columns;
  right.x              = b;
  right.xtype          = CHOLMOD_REAL;
  right.dtype          = CHOLMOD_DOUBLE;
  x      = cholmod_solve(CHOLMOD_A, factor->l, &right, &c);
  result = code(&c, why);
  if (x) memcpy(b, x->x, n * (size_t)columns * sizeof(double));
  else if (!result) result = FF_FAILED;
  cholmod_free_dense(&x, &c);
  cholmod_finish(&c);
  as_before(levels);
  return result;
}

void ff_cholmod_diagonal(const ff_cholmod *factor, double *diagonal)
{
  const cholmod_factor *l = factor->l;
  const double         *x = (const double *)l->x;

  if (!l->is_super) {
    for (size_t j = 0; j < l->n; j++) diagonal[j] = x[((const int *)l->p)[j]];
    return;
  }
  const int *super = (const int *)l->super, *pi = (const int *)l->pi, *px = (const int *)l->px;
  for (size_t s = 0; s < l->nsuper; s++) {
    const size_t rows = (size_t)(pi[s + 1] - pi[s]);
    for (int j = super[s]; j < super[s + 1]; j++) diagonal[j] = x[(size_t)px[s] + (size_t)(j - super[s]) * (rows + 1)];
  }
}

int ff_cholmod_supernodes(const ff_cholmod *factor, int *n, const int **super, const int **pi, const int **px, const int **s, const double **x)
{
  const cholmod_factor *l = factor->l;

  if (!l->is_super || !l->x) return FF_FAILED;
  *n     = (int)l->nsuper;
  *super = (const int *)l->super;
  *pi    = (const int *)l->pi;
  *px    = (const int *)l->px;
  *s     = (const int *)l->s;
  *x     = (const double *)l->x;
  return 0;
}

double ff_cholmod_bytes(const ff_cholmod *factor)
{
  const cholmod_factor *l = factor->l;
  const double          n = (double)l->n;

  if (l->is_super) return 8.0 * (double)l->xsize + 4.0 * (double)(l->ssize + 3 * (l->nsuper + 1)) + 8.0 * n;
  return 12.0 * (double)l->nzmax + 24.0 * n;
}

void ff_cholmod_free(ff_cholmod *factor)
{
  cholmod_common c;

  if (!factor) return;
  start(&c, 0);
  cholmod_free_factor(&factor->l, &c);
  cholmod_finish(&c);
  free(factor);
}

  #if !defined(NPARTITION)
int ff_have_metis(void)
{
  return 1;
}

int ff_metis_order(int n, const int *row, const int *col, int *order)
{
  cholmod_common c;
  /* CHOLMOD takes one triangle of a symmetric pattern. */
  int *ptr = malloc(((size_t)n + 1) * sizeof(int)), *index, result, why;

  if (!ptr) return FF_NO_MEMORY;
  index = malloc(((size_t)row[n] / 2 + 1) * sizeof(int));
  if (!index) {
    free(ptr);
    return FF_NO_MEMORY;
  }
  ptr[0] = 0;
  for (int j = 0, k = 0; j < n; j++) {
    for (int e = row[j]; e < row[j + 1]; e++)
      if (col[e] < j) index[k++] = col[e];
    ptr[j + 1] = k;
  }
  start(&c, 0);
  c.metis_nswitch  = 0;
  cholmod_sparse a = upper(n, ptr, index, NULL);
  const int ok     = cholmod_metis(&a, NULL, 0, 0, order, &c);
  result           = code(&c, &why);
  if (!ok && !result) result = FF_FAILED;
  cholmod_finish(&c);
  free(index);
  free(ptr);
  return result;
}
  #endif

#else

int ff_have_cholmod(void)
{
  return 0;
}
int ff_cholmod_analyse(int n, const int *ptr, const int *row, int supernodal, ff_cholmod **out, int *why)
{
  return FF_ABSENT;
}
int ff_cholmod_factor(const ff_cholmod *analysis, const int *ptr, const int *row, const double *value, ff_cholmod **out, int *column, int *why)
{
  return FF_ABSENT;
}
int ff_cholmod_solve(const ff_cholmod *factor, int columns, double *b, int *why)
{
  return FF_ABSENT;
}
void ff_cholmod_diagonal(const ff_cholmod *factor, double *diagonal) { }
int ff_cholmod_supernodes(const ff_cholmod *factor, int *n, const int **super, const int **pi, const int **px, const int **s, const double **x)
{
  return FF_ABSENT;
}
double ff_cholmod_bytes(const ff_cholmod *factor)
{
  return 0;
}
void ff_cholmod_free(ff_cholmod *factor) { }
#endif

#if !defined(FF_HAVE_CHOLMOD) || defined(NPARTITION)
int ff_have_metis(void)
{
  return 0;
}
int ff_metis_order(int n, const int *row, const int *col, int *order)
{
  return FF_ABSENT;
}
#endif
