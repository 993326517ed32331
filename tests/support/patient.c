/*
   Ranks that wait for a message look for it all the time, and Open MPI calls sched_yield() in between. On a machine
   with more processes than cores the core then goes to whoever computes, for milliseconds, and so does each message. A
   short sleep leaves the core, too, and ends in time; where nobody else wants the core it takes many times as long.
   So a rank sleeps for a while after its core has been away, and yields at other times.
*/
#define _GNU_SOURCE
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

/* Seconds after which a core has been away, and for which a rank then sleeps. */
#define AWAY 1e-3
#define WHILE 60e-3

static double seconds(void)
{
  struct timespec now;

  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int sched_yield(void)
{
  static _Thread_local double until;
  const struct timespec       time  = {0, 20000};
  const double                begin = seconds();

  if (begin < until) return nanosleep(&time, 0);
  syscall(SYS_sched_yield);
  if (seconds() - begin > AWAY) until = seconds() + WHILE;
  return 0;
}
