/*
   What makes programs with PETSc cheaper for a machine that runs thousands of them, in a library that is loaded first.

   Ranks that wait for a message look for it all the time, and Open MPI calls sched_yield() in between. On a machine
   with more processes than cores the core then goes to whoever computes, for milliseconds, and so does each message. A
   short sleep leaves the core, too, and ends in time; where nobody else computes it takes many times as long. So a rank
   yields at first, and sleeps where it has waited long or its core has just been away.
*/
#define _GNU_SOURCE
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
   The tests do not use it, so this library bears its name (mpi.rs) and they stay unloaded. PETSc's calls of ML are
   looked up when they are made; this variable is looked up at once.
*/
void *ml_void_mem_ptr;
