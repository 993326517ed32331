/* The process: its standard output, its memory, and the signals that ask it to end. */
#include "shim.h"
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

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

void ff_no_memory(size_t bytes)
{
  static volatile sig_atomic_t said = 0;
  const char *rank = getenv("OMPI_COMM_WORLD_RANK");
  char        text[200];
  int         length;

  if (!rank) rank = getenv("PMI_RANK");
  length = snprintf(text, sizeof(text),
                    "Error%s%.9s: there is no memory for another %.1f MB, "
                    "take fewer elements per subdomain or ranks on more machines\n",
                    rank ? " on rank " : "", rank ? rank : "", 1e-6 * (double)bytes);
  /* Other threads may find the same. */
  if (!said++ && length > 0 && write(STDERR_FILENO, text, (size_t)length) < 0) _exit(3);
  _exit(3);
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

/* The streams to which PETSc prints, while another one keeps it: its own, and that of C for lists of types, which the C
   library of GNU lets us replace. */
static FILE  *printed_to, *keeping;
#ifdef __GLIBC__
static FILE *printed_too;
#endif
static char  *kept;
static size_t kept_length;

int ff_print_keep(void)
{
  kept    = NULL;
  keeping = open_memstream(&kept, &kept_length);
  if (!keeping) return 0;
  printed_to   = PETSC_STDOUT;
  PETSC_STDOUT = keeping;
#ifdef __GLIBC__
  printed_too = stdout;
  stdout      = keeping;
#endif
  return 1;
}

char *ff_print_kept(void)
{
  PETSC_STDOUT = printed_to;
#ifdef __GLIBC__
  stdout = printed_too;
#endif
  (void)fclose(keeping);
  return kept;
}

void ff_print_free(char *text)
{
  free(text);
}
