/* METIS's nested dissection, through CHOLMOD. */
#include "ordering.h"

#if defined(FF_HAVE_METIS)
  #include <stdlib.h>
  #include <string.h>
  #if __has_include(<suitesparse/cholmod.h>)
    #include <suitesparse/cholmod.h>
  #else
    #include <cholmod.h>
  #endif

int ff_have_metis(void)
{
  return 1;
}

static int order_triangle(int n, int *ptr, int *index, int *order)
{
  cholmod_common c;
  cholmod_sparse a;
  int            ok, status;

  memset(&a, 0, sizeof(a));
  a.nrow = a.ncol = (size_t)n;
  a.nzmax         = (size_t)ptr[n];
  a.p             = ptr;
  a.i             = index;
  a.stype         = 1;
  a.itype         = CHOLMOD_INT;
  a.xtype         = CHOLMOD_PATTERN;
  a.dtype         = CHOLMOD_DOUBLE;
  a.sorted = a.packed = 1;

  cholmod_start(&c);
  c.print         = 0;
  c.metis_nswitch = 0;
  ok              = cholmod_metis(&a, NULL, 0, 0, order, &c);
  status          = c.status;
  cholmod_finish(&c);
  if (status == CHOLMOD_OUT_OF_MEMORY || status == CHOLMOD_TOO_LARGE) return FF_NO_MEMORY;
  return ok && status == CHOLMOD_OK ? 0 : FF_FAILED;
}

int ff_metis_order(int n, const int *row, const int *col, int *order)
{
  /* CHOLMOD takes one triangle of a symmetric pattern. */
  int *ptr    = malloc(((size_t)n + 1) * sizeof(int));
  int *index  = malloc(((size_t)row[n] / 2 + 1) * sizeof(int));
  int  result = FF_NO_MEMORY;

  if (ptr && index) {
    ptr[0] = 0;
    for (int j = 0, k = 0; j < n; j++) {
      for (int e = row[j]; e < row[j + 1]; e++)
        if (col[e] < j) index[k++] = col[e];
      ptr[j + 1] = k;
    }
    result = order_triangle(n, ptr, index, order);
  }
  free(index);
  free(ptr);
  return result;
}

#else

int ff_have_metis(void)
{
  return 0;
}
int ff_metis_order(int n, const int *row, const int *col, int *order)
{
  return FF_ABSENT;
}
#endif
