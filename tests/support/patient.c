/*
   What makes programs with PETSc cheaper for a machine that runs thousands of them, in a library that is loaded first.

   Ranks that wait for a message look for it all the time, and Open MPI calls sched_yield() in between. On a machine
   with more processes than cores the core then goes to whoever computes, for milliseconds, and so does each message. A
   short sleep leaves the core, too, and ends in time; where nobody else computes it takes many times as long. So a rank
   yields at first, and sleeps where it has waited long or its core has just been away.
*/
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* Calls with less than this between them, in seconds, are one wait. */
#define ONE_WAIT 20e-6
/* How often a rank yields in a wait before it sleeps. */
#define YIELDS 100
/* Seconds after which a core has been away, and for which a rank then sleeps. */
#define AWAY 1e-3
#define WHILE 10e-3

static double seconds(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int sched_yield(void)
{
  static _Thread_local double until, last;
  static _Thread_local int    yields;
  const struct timespec       time  = {0, 50000};
  const double                begin = seconds();

  if (begin - last > ONE_WAIT) yields = 0;
  if (begin > until && yields < YIELDS) {
    yields++;
    syscall(SYS_sched_yield);
    last = seconds();
    if (last - begin > AWAY) until = last + WHILE;
  } else {
    nanosleep(&time, 0);
    last = seconds();
  }
  return 0;
}

/*
   Debian's PETSc is linked with Trilinos' ML, whose 17 libraries take a third of the time in which a program starts.
   The tests do not use it, so this library bears its name (mpi.rs) and they stay unloaded. It has what PETSc refers to.
*/
void *ml_void_mem_ptr;

#define ABSENT(name)                                                           \
  void name(void)                                                              \
  {                                                                            \
    fputs("tests/support/patient.c: tests have PETSc without ML\n", stderr);   \
    abort();                                                                   \
  }

ABSENT(ML_Aggregate_Create) ABSENT(ML_Aggregate_Destroy) ABSENT(ML_Aggregate_Set_CoarsenScheme_Coupled)
ABSENT(ML_Aggregate_Set_CoarsenScheme_METIS) ABSENT(ML_Aggregate_Set_CoarsenScheme_MIS)
ABSENT(ML_Aggregate_Set_DampingFactor) ABSENT(ML_Aggregate_Set_Dimensions) ABSENT(ML_Aggregate_Set_MaxCoarseSize)
ABSENT(ML_Aggregate_Set_NullSpace) ABSENT(ML_Aggregate_Set_Threshold) ABSENT(ML_Aggregate_VizAndStats_Clean)
ABSENT(ML_Aggregate_VizAndStats_Setup) ABSENT(ML_Comm_Set_UsrComm) ABSENT(ML_Create) ABSENT(ML_Destroy)
ABSENT(ML_Gen_AmatrixRAP) ABSENT(ML_Gen_MGHierarchy_UsingAggregation)
ABSENT(ML_Gen_MultiLevelHierarchy_UsingAggregation) ABSENT(ML_Init_Amatrix) ABSENT(ML_Operator_Apply)
ABSENT(ML_Operator_Clean) ABSENT(ML_Operator_Getrow) ABSENT(ML_Operator_Init) ABSENT(ML_Repartition_Activate)
ABSENT(ML_Repartition_Set_LargestMinMaxRatio) ABSENT(ML_Repartition_Set_MinPerProc)
ABSENT(ML_Repartition_Set_Partitioner) ABSENT(ML_Repartition_Set_PutOnSingleProc) ABSENT(ML_Set_Amatrix_Getrow)
ABSENT(ML_Set_Amatrix_Matvec) ABSENT(ML_Set_PrintLevel) ABSENT(ML_Set_SpectralNormScheme_Anorm)
ABSENT(ML_Set_Symmetrize) ABSENT(ML_build_global_numbering)
