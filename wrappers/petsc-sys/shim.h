/* Macros, inline functions and version differences of PETSc and SLEPc as plain functions.

   Everything here must compile against PETSc 3.18 to 3.26. */
#if !defined(FETIFETI_SHIM_H)
#define FETIFETI_SHIM_H

#include <petscksp.h>
#include <slepceps.h>

/* PETSC_COMM_WORLD is a variable, PETSC_COMM_SELF a macro. */
MPI_Comm ff_comm_world(void);
MPI_Comm ff_comm_self(void);
/* A communicator of Fortran. */
MPI_Comm ff_comm_f2c(int comm);

/* PetscError() for the first frame of an error; it is variadic and takes the message as a format. */
int ff_error(MPI_Comm comm, int line, const char *function, const char *file, int code, const char *message);

/* Ties a context to an object: drop(context) runs when the object dies or gets another context. */
int ff_attach(PetscObject object, const char *key, void *context, void (*drop)(void *));
/* The context tied under this key, or NULL. */
void *ff_attached(PetscObject object, const char *key);

int ff_mat_shell_set_mult(Mat mat, int (*f)(Mat, Vec, Vec));
int ff_mat_shell_set_mult_transpose(Mat mat, int (*f)(Mat, Vec, Vec));
int ff_mat_shell_set_diagonal(Mat mat, int (*f)(Mat, Vec));
int ff_mat_shell_set_view(Mat mat, int (*f)(Mat, PetscViewer));
int ff_pc_shell_set_apply(PC pc, int (*f)(PC, Vec, Vec));
int ff_pc_shell_set_apply_transpose(PC pc, int (*f)(PC, Vec, Vec));
int ff_pc_shell_set_view(PC pc, int (*f)(PC, PetscViewer));
int ff_st_shell_set_apply(ST st, int (*f)(ST, Vec, Vec));

/* KSPSolve() that may stop early. From iteration `first` on, in every third one, it stops if the largest singular value
   estimate is above `limit` while the residual is above `rest`; a negative `first` means never. After every iteration
   it calls `look`, unless that is NULL, with `looker` and the residual, and stops if `stop` is set. `stopped` says why;
   the reason is KSP_CONVERGED_ITS then. */
#define FF_EIGENVALUE 1
#define FF_LOOK       2
typedef int (*ff_look)(void *looker, double residual, int *stop);
int ff_ksp_solve_watched(KSP ksp, Vec b, Vec x, int first, double limit, double rest, ff_look look, void *looker,
                         int *stopped);

/* EPSSolve() for one eigenvalue with the relative tolerance tol of the solver. It also ends
   1. where the value, which the smallest eigenvalue does not exceed, is above `floor` by tol at most (NaN: no floor),
   2. from restart `first` on, where the value has settled: with a relative residual of at most `loose` and a change d
      over `patience` restarts so small that d restarts / patience is below tol. The error is no more than that where
      the value approaches its limit like 1/restarts or faster, as it does at the end of a cluster.
   `value` and the relative `residual` are those at the end; `found` is 0, 1, or 2 for a value that has settled. Another
   convergence test than the usual one, chosen by an option, is left alone. `told` is called at every restart. */
typedef int (*ff_told)(void *who, int restarts, double residual);
int ff_eps_solve_settled(EPS eps, double floor, int first, int patience, double loose, ff_told told, void *who,
                         double *value, double *residual, int *found);

/* Collects PETSc's error frames instead of printing them. */
typedef void (*ff_trace)(int line, const char *function, const char *file, int code, int initial, const char *message);
int ff_push_error_handler(ff_trace trace);

/* part[i] of each vertex of a symmetric graph with edge weights in compressed rows, by MatPartitioning on this process
   alone. The options have this prefix: -<prefix>mat_partitioning_type sets the type. */
int ff_partition(const char *prefix, PetscInt n, const PetscInt *row, const PetscInt *col, const PetscInt *weight,
                 PetscInt parts, PetscInt *part);

/* Whether the local-to-global map of a MATIS may list a dof several times, once for each of several subdomains (PETSc
   3.21 and later). */
int ff_is_repeated(Mat mat, int *repeated);
/* Allows that, before the map is set. */
int ff_allow_repeated(Mat mat);

/* Whether this PETSc has a type of PC, and a package for Cholesky factorisations on one process. */
int ff_has_pc(const char *type, int *found);
int ff_has_cholesky(const char *package, int *found);

/* Whether any option begins with `start` (dash included). */
int ff_options_any(const char *start, PetscBool *found);
/* Messages, their bytes and all-reduces that PETSc has counted on this rank; 0 where it was built without its log. */
int ff_counters(double counts[3]);

int ff_event_begin(int event);
int ff_event_end(int event);
int ff_citation(const char *text, int *set);
int ff_help_print(MPI_Comm comm, const char *text);
/* Keeps what PETSc prints on standard output from now on, instead of printing it; 0 if there is no memory. */
int ff_print_keep(void);
/* Prints it again; what was kept, to be freed by ff_print_free. */
char *ff_print_kept(void);
void ff_print_free(char *kept);
int ff_viewer_print(PetscViewer viewer, const char *text);
int ff_viewer_is_ascii(PetscViewer viewer, int *ascii);
int ff_free(void *memory);
/* What PETSc prints on standard output, monitors and views among it, goes to standard error from now on. */
void ff_print_on_stderr(void);
/* SIGINT and SIGTERM are noted from now on, until as many calls of ff_signals_leave; a second one ends the program. */
void ff_signals_watch(void);
void ff_signals_leave(void);
/* The signal that was noted last, 0 without any. */
int ff_signals_noted(void);
/* Ends the program with exit code 3 and a sentence on memory. It does not return, and needs no memory. */
void ff_no_memory(size_t bytes);
/* Sends SIGTERM to a process. */
void ff_terminate(int pid);
/* Largest resident set of this process so far, in bytes. */
double ff_max_memory(void);

#endif
