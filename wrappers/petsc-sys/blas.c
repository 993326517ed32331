/* What can be asked of the BLAS that this process runs with. */
#define _GNU_SOURCE
#include "direct.h"
#include <dlfcn.h>

int ff_blas_takes_threads(void)
{
  /* 0 where OpenBLAS is built for one thread, with its buffers unguarded; it may come in at run time in the place of another BLAS. */
  int (*parallel)(void);

  *(void **)&parallel = dlsym(RTLD_DEFAULT, "openblas_get_parallel");
  return !parallel || parallel() != 0;
}
