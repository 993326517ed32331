/* The process: its standard output, its memory, and the signals that ask it to end. */
#include "shim.h"
#include <signal.h>
#include <string.h>
#include <sys/resource.h>

static volatile sig_atomic_t noted    = 0;
static int                   watchers = 0;
static struct sigaction      before[2];

static void note(int signal)
{
  noted = signal;
}

void ff_signals_watch(void)
{
  struct sigaction action;

  if (watchers++) return;
  memset(&action, 0, sizeof(action));
  action.sa_handler = note;
  action.sa_flags   = SA_RESTART | SA_RESETHAND;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, &before[0]);
  sigaction(SIGTERM, &action, &before[1]);
}

void ff_signals_leave(void)
{
  if (--watchers) return;
  sigaction(SIGINT, &before[0], NULL);
  sigaction(SIGTERM, &before[1], NULL);
}

int ff_signals_noted(void)
{
  return (int)noted;
}

void ff_terminate(int pid)
{
  if (pid > 0) kill((pid_t)pid, SIGTERM);
}

void ff_print_on_stderr(void)
{
  PETSC_STDOUT = stderr;
}

double ff_max_memory(void)
{
  struct rusage usage;

  if (getrusage(RUSAGE_SELF, &usage)) return 0.0;
#if defined(__APPLE__)
  return (double)usage.ru_maxrss;
#else
  return 1024.0 * (double)usage.ru_maxrss;
#endif
}
