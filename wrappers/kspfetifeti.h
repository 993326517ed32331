/* Between the KSP in C and the method in Rust (src/capi). The public header is fetifeti.h. */
#if !defined(KSPFETIFETI_H)
#define KSPFETIFETI_H

#include <petsc/private/kspimpl.h>
#include "petsc-sys/compat.h"

/* The data of a KSP of this type. */
typedef struct {
  void            *solver; /* the solver in Rust; NULL before set-up, and after a failed set-up */
  PetscObjectId    id;     /* the operator at the last set-up, and its state */
  PetscObjectState state;
  PetscInt         body;   /* body of this rank; -1: not given */
  IS               bodies; /* body of each row that this rank owns; NULL: not given */
  IS               primal; /* unknowns that are to be primal; NULL: none are named */
  char            *label;  /* label of the mesh's cells that names the bodies; NULL: none */
  PetscBool        true_residual; /* go on until the residual of the host's equations is below the tolerance */
  PetscBool        stale; /* set up again, even if the operator has not changed */
  PetscBool        whole; /* the next set-up is one of everything: options may have changed */
  PetscObjectId    near, null; /* the near-null space and the null space at the last set-up; 0: none */
  PetscInt         base;  /* iterations of earlier runs of the inner KSP in this solve */
  PetscInt         last;  /* last iteration that the monitors have seen; -1: none */
  PetscBool        running; /* the inner KSP is running */
  PetscReal        largest, smallest; /* eigenvalue estimates from the longest run of the inner KSP in the last solve */
  PetscInt         begun; /* the column of KSPMatSolve() that is solved; -1: none */
  KSPConvergedReason failed; /* why there is no solver */
} KSP_FETIFETI;

/* The return value of a Rust function: 0; FF_SENTENCE with a message to be fetched, the same on all ranks; FF_UNFIT, a
   sentence about a matrix that cannot be factored or a load that is no number; FF_RAISED, after a PETSc error that has
   been reported; or FF_ALONE, a sentence that other ranks may not have. */
#define FF_SENTENCE 1
#define FF_UNFIT    2
#define FF_RAISED   3
#define FF_ALONE    4

/* Longest name of an option's value with its end. */
#define FETIFETI_NAME 16
/* Longest line of counts with its end. */
#define FETIFETI_LINE 256

typedef struct {
  int    body;     /* body of this rank, or -1 */
  IS     bodies;   /* body of each row that this rank owns, or NULL */
  IS     primal;   /* unknowns that are to be primal, listed by any rank, or NULL */
  double goal;     /* norm of b - A x to reach, or -1: no such test */
  double rtol, abstol, divtol;
  int    max_it;
  int    begun; /* the number of the right-hand side in the last fetifeti_plugin_together(), or -1 */
} FetiFetiWishes;

typedef struct {
  int    bodies, floating, kernel, subdomains, primal;
  double local_rows, global_rows;
  char   scaling[FETIFETI_NAME];
  char   work[FETIFETI_LINE]; /* what set-ups have taken so far */
} FetiFetiFacts;

typedef struct {
  int    iterations;
  int    reason; /* KSPConvergedReason */
  double largest, smallest; /* eigenvalues, or 0 */
  int    explained; /* the last sentence explains the reason */
} FetiFetiResult;

/* *solver is NULL, or a solver that is brought up to date where the matrix has the same structure. */
int  fetifeti_plugin_setup(MPI_Comm comm, Mat a, const char *prefix, const FetiFetiWishes *wishes, void **solver);
int  fetifeti_plugin_solve(void *solver, Mat a, const FetiFetiWishes *wishes, Vec b, Vec x, FetiFetiResult *result);
int  fetifeti_plugin_together(void *solver, const FetiFetiWishes *wishes, int n, const Vec b[]);
int  fetifeti_plugin_solution(void *solver, Vec x, int *there);
KSP  fetifeti_plugin_inner(void *solver);
void fetifeti_plugin_facts(void *solver, FetiFetiFacts *facts);
void fetifeti_plugin_free(void *solver);
/* The last sentence, and its PETSc error code. */
const char *fetifeti_plugin_message(int *code);

/* Called by the symbols that the library exports. */
int ff_plugin_register(int avx2);
int ff_processor(int avx2);
int ff_processor_suits(void);
int ff_plugin_set_body(KSP ksp, PetscInt body);
int ff_plugin_set_body_is(KSP ksp, IS bodies);
int ff_plugin_set_body_label(KSP ksp, const char *name);
int ff_plugin_set_primal(KSP ksp, IS dofs);
int ff_plugin_get_inner(KSP ksp, KSP *inner);
int ff_plugin_get_ksp(PC pc, KSP *ksp);

/* Creates a KSP of this type (kspfetifeti.c). */
PetscErrorCode KSPCreate_FETIFETI(KSP ksp);

/* Converts a status of Rust to a PETSc error; the requests to Rust; b without its part in the kernel (B), and what the
   initial guess x leaves of it (R, which may be B) with its norm (kspfetifeti.c). */
PetscErrorCode ff_raise(KSP ksp, int status);
PetscErrorCode ff_wishes(KSP ksp, FetiFetiWishes *wishes);
PetscErrorCode ff_load(KSP ksp, Mat A, MatNullSpace kernel, Vec b, Vec x, Vec B, Vec R, PetscReal *norm);

/* Solves for all columns of B (kspmatsolve.c). */
PetscErrorCode KSPMatSolve_FETIFETI(KSP ksp, Mat B, Mat X);

/* Creates a PC of this type (pcfetifeti.c). */
PetscErrorCode PCCreate_FETIFETI(PC pc);

/* Bodies (kspbodies.c). */
PetscErrorCode ff_label_body(KSP ksp, Mat A, const char *name, PetscInt *body);
PetscErrorCode ff_compose_bodies(KSP ksp);
PetscErrorCode ff_forget_bodies(KSP ksp);

#endif
