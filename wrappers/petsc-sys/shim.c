#include "shim.h"
#include "compat.h"
#include <string.h>

MPI_Comm ff_comm_world(void)
{
  return PETSC_COMM_WORLD;
}

MPI_Comm ff_comm_self(void)
{
  return PETSC_COMM_SELF;
}

MPI_Comm ff_comm_f2c(int comm)
{
  return MPI_Comm_f2c((MPI_Fint)comm);
}

int ff_error(MPI_Comm comm, int line, const char *function, const char *file, int code, const char *message)
{
  return (int)PetscError(comm, line, function, file, (PetscErrorCode)code, PETSC_ERROR_INITIAL, "%s", message);
}

/* ---- contexts: a PetscContainer composed with the object, which STSHELL of 3.18 needs and all versions have ---- */

typedef struct {
  void *context;
  void (*drop)(void *);
} Attached;

static PetscErrorCode AttachedFree(Attached *attached)
{
  attached->drop(attached->context);
  return PetscFree(attached);
}

FF_DROP(AttachedDestroy, AttachedFree, Attached)

int ff_attach(PetscObject object, const char *key, void *context, void (*drop)(void *))
{
  Attached      *attached;
  PetscContainer container;

  PetscCall(PetscNew(&attached));
  attached->context = context;
  attached->drop    = drop;
  PetscCall(PetscContainerCreate(PetscObjectComm(object), &container));
  PetscCall(PetscContainerSetPointer(container, attached));
  PetscCall(FFContainerSetDrop(container, AttachedDestroy));
  PetscCall(PetscObjectCompose(object, key, (PetscObject)container));
  PetscCall(PetscContainerDestroy(&container));
  return 0;
}

void *ff_attached(PetscObject object, const char *key)
{
  PetscContainer container = NULL;
  void          *attached  = NULL;

  if (PetscObjectQuery(object, key, (PetscObject *)&container) || !container) return NULL;
  if (PetscContainerGetPointer(container, &attached) || !attached) return NULL;
  return ((Attached *)attached)->context;
}

/* ---- shells ---- */

int ff_mat_shell_set_mult(Mat mat, int (*f)(Mat, Vec, Vec))
{
  return (int)MatShellSetOperation(mat, MATOP_MULT, FF_OPERATION(f));
}

int ff_mat_shell_set_mult_transpose(Mat mat, int (*f)(Mat, Vec, Vec))
{
  return (int)MatShellSetOperation(mat, MATOP_MULT_TRANSPOSE, FF_OPERATION(f));
}

int ff_mat_shell_set_diagonal(Mat mat, int (*f)(Mat, Vec))
{
  return (int)MatShellSetOperation(mat, MATOP_GET_DIAGONAL, FF_OPERATION(f));
}

int ff_mat_shell_set_view(Mat mat, int (*f)(Mat, PetscViewer))
{
  return (int)MatShellSetOperation(mat, MATOP_VIEW, FF_OPERATION(f));
}

/* PetscErrorCode is an enum from 3.19 on; an enum and an int return alike, so the casts only silence the compiler. */
int ff_pc_shell_set_apply(PC pc, int (*f)(PC, Vec, Vec))
{
  return (int)PCShellSetApply(pc, (PetscErrorCode(*)(PC, Vec, Vec))f);
}

int ff_pc_shell_set_apply_transpose(PC pc, int (*f)(PC, Vec, Vec))
{
  return (int)PCShellSetApplyTranspose(pc, (PetscErrorCode(*)(PC, Vec, Vec))f);
}

int ff_pc_shell_set_view(PC pc, int (*f)(PC, PetscViewer))
{
  return (int)PCShellSetView(pc, (PetscErrorCode(*)(PC, PetscViewer))f);
}

int ff_st_shell_set_apply(ST st, int (*f)(ST, Vec, Vec))
{
  return (int)STShellSetApply(st, (PetscErrorCode(*)(ST, Vec, Vec))f);
}

/* ---- errors ---- */

static PetscErrorCode CollectFrame(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                                   PetscErrorType type, const char *message, void *context)
{
  (void)comm;
  ((ff_trace)context)(line, function, file, (int)code, type == PETSC_ERROR_INITIAL, message);
  return code;
}

int ff_push_error_handler(ff_trace trace)
{
  return (int)PetscPushErrorHandler(CollectFrame, (void *)trace);
}

/* ---- Krylov methods ---- */

typedef PetscErrorCode (*ff_test)(KSP, PetscInt, PetscReal, KSPConvergedReason *, void *);

typedef struct {
  ff_test  test; /* the test that decides about convergence */
  void    *context;
  int      first, stopped;
  double   limit, rest;
  ff_look  look;
  void    *looker;
} ff_watch;

static PetscErrorCode ff_watched(KSP ksp, PetscInt it, PetscReal rnorm, KSPConvergedReason *reason, void *data)
{
  ff_watch *watch = (ff_watch *)data;
  PetscReal large = 0.0, small = 0.0;
  int       stop = 0;

  PetscCall((*watch->test)(ksp, it, rnorm, reason, watch->context));
  if (*reason) return 0;
  if (watch->first >= 0 && it >= watch->first && (it - watch->first) % 3 == 0 && rnorm > watch->rest) {
    PetscCall(KSPComputeExtremeSingularValues(ksp, &large, &small));
    if (large > watch->limit) watch->stopped = FF_EIGENVALUE;
  }
  if (!watch->stopped && watch->look) {
    PetscCall((PetscErrorCode)(*watch->look)(watch->looker, (double)rnorm, &stop));
    if (stop) watch->stopped = FF_LOOK;
  }
  if (watch->stopped) *reason = KSP_CONVERGED_ITS;
  return 0;
}

int ff_ksp_solve_watched(KSP ksp, Vec b, Vec x, int first, double limit, double rest, ff_look look, void *looker,
                         int *stopped)
{
  FFDropTest     drop  = NULL;
  ff_watch       watch = {NULL, NULL, first, 0, limit, rest, look, looker};
  PetscErrorCode code;

  PetscCall(KSPGetAndClearConvergenceTest(ksp, &watch.test, &watch.context, &drop));
  PetscCall(KSPSetConvergenceTest(ksp, ff_watched, &watch, NULL));
  code = KSPSolve(ksp, b, x);
  PetscCall(KSPSetConvergenceTest(ksp, watch.test, watch.context, drop));
  *stopped = watch.stopped;
  return (int)code;
}

/* ---- eigenvalues ---- */

#define FF_PATIENCE 64

typedef struct {
  double floor, loose;
  int    first, patience, restarts, found;
  double before[FF_PATIENCE]; /* the values of the last restarts; the oldest one is replaced next */
  double value, residual;
  ff_told told;
  void   *who;
} ff_settling;

static int HasSettled(const ff_settling *s, double tol, double size)
{
  double change = PetscAbsReal(s->value - s->before[s->restarts % s->patience]);

  return s->restarts >= s->first && s->restarts >= s->patience && s->residual <= s->loose &&
         change * s->restarts <= tol * size * s->patience;
}

static PetscErrorCode ff_settled(EPS eps, PetscScalar eigr, PetscScalar eigi, PetscReal res, PetscReal *errest,
                                 void *data)
{
  ff_settling *s    = (ff_settling *)data;
  double       size = PetscMax(PetscAbsReal(eigr), PETSC_MIN_REAL), above;
  PetscReal    tol;

  (void)eigi;
  *errest = res / size;
  if (s->found) return 0; /* SLEPc asks for the next eigenvalue, too. */
  PetscCall(EPSGetTolerances(eps, &tol, NULL));
  s->value    = eigr;
  s->residual = *errest;
  above       = s->value - s->floor;
  if (*errest < tol || (above >= -1e-10 * size && above <= tol * size)) s->found = 1;
  else if (HasSettled(s, tol, size)) s->found = 2;
  if (s->found) *errest = 0.0;
  s->before[s->restarts % s->patience] = s->value;
  s->restarts++;
  return (PetscErrorCode)s->told(s->who, s->restarts, s->residual);
}

int ff_eps_solve_settled(EPS eps, double floor, int first, int patience, double loose, ff_told told, void *who,
                         double *value, double *residual, int *found)
{
  ff_settling    s = {floor, loose, first, patience, 0, 0, {0.0}, 0.0, 0.0, told, who};
  EPSConv        kind;
  PetscInt       n;
  PetscErrorCode code;

  *found = 0;
  if (patience < 1 || patience > FF_PATIENCE) return PETSC_ERR_ARG_OUTOFRANGE;
  PetscCall(EPSGetConvergenceTest(eps, &kind));
  if (kind == EPS_CONV_REL) PetscCall(EPSSetConvergenceTestFunction(eps, ff_settled, &s, NULL));
  code = EPSSolve(eps);
  if (kind == EPS_CONV_REL) PetscCall(EPSSetConvergenceTest(eps, kind));
  PetscCall(code);
  if (kind == EPS_CONV_REL) {
    *found    = s.found;
    *value    = s.value;
    *residual = s.residual;
    return 0;
  }
  PetscCall(EPSGetConverged(eps, &n));
  if (n < 1) return 0;
  PetscCall(EPSGetEigenvalue(eps, 0, value, NULL));
  PetscCall(EPSGetErrorEstimate(eps, 0, residual));
  *found = 1;
  return 0;
}

/* ---- graphs and MATIS ---- */

int ff_partition(const char *prefix, PetscInt n, const PetscInt *row, const PetscInt *col, const PetscInt *weight,
                 PetscInt parts, PetscInt *part)
{
  MatPartitioning partitioning;
  Mat             graph;
  IS              is;
  const PetscInt *found;
  PetscInt       *i, *j, *w, k;

  /* The matrix frees these. */
  PetscCall(PetscMalloc1(n + 1, &i));
  PetscCall(PetscMalloc1(row[n], &j));
  PetscCall(PetscMalloc1(row[n], &w));
  for (k = 0; k <= n; k++) i[k] = row[k];
  for (k = 0; k < row[n]; k++) j[k] = col[k], w[k] = weight[k];
  PetscCall(MatCreateMPIAdj(PETSC_COMM_SELF, n, n, i, j, w, &graph));
  PetscCall(MatPartitioningCreate(PETSC_COMM_SELF, &partitioning));
  PetscCall(PetscObjectSetOptionsPrefix((PetscObject)partitioning, prefix));
  PetscCall(MatPartitioningSetAdjacency(partitioning, graph));
  PetscCall(MatPartitioningSetNParts(partitioning, parts));
  PetscCall(MatPartitioningSetUseEdgeWeights(partitioning, PETSC_TRUE));
  PetscCall(MatPartitioningSetFromOptions(partitioning));
  PetscCall(MatPartitioningApply(partitioning, &is));
  PetscCall(ISGetIndices(is, &found));
  for (k = 0; k < n; k++) part[k] = found[k];
  PetscCall(ISRestoreIndices(is, &found));
  PetscCall(ISDestroy(&is));
  PetscCall(MatPartitioningDestroy(&partitioning));
  PetscCall(MatDestroy(&graph));
  return 0;
}

int ff_is_repeated(Mat mat, int *repeated)
{
  PetscBool flag;

  PetscCall(FFIsRepeated(mat, &flag));
  *repeated = flag ? 1 : 0;
  return 0;
}

int ff_allow_repeated(Mat mat)
{
  return (int)FFAllowRepeated(mat);
}

int ff_has_pc(const char *type, int *found)
{
  PetscErrorCode (*create)(PC) = NULL;

  PetscCall(PCInitializePackage());
  PetscCall(PetscFunctionListFind(PCList, type, &create));
  *found = create ? 1 : 0;
  return 0;
}

int ff_has_cholesky(const char *package, int *found)
{
  PetscBool known = PETSC_FALSE;

  PetscCall(MatInitializePackage());
  PetscCall(MatSolverTypeGet(package, MATSEQAIJ, MAT_FACTOR_CHOLESKY, &known, NULL, NULL));
  *found = known ? 1 : 0;
  return 0;
}

/* ---- log, citations, printing ---- */

int ff_counters(double counts[3])
{
#if defined(PETSC_USE_LOG)
  counts[0] = petsc_isend_ct + petsc_send_ct;
  counts[1] = petsc_isend_len + petsc_send_len;
  counts[2] = petsc_allreduce_ct;
  return 1;
#else
  counts[0] = counts[1] = counts[2] = 0.0;
  return 0;
#endif
}

int ff_event_begin(int event)
{
  PetscCall(PetscLogEventBegin(event, 0, 0, 0, 0));
  return 0;
}

int ff_event_end(int event)
{
  PetscCall(PetscLogEventEnd(event, 0, 0, 0, 0));
  return 0;
}

int ff_citation(const char *text, int *set)
{
  PetscBool flag = *set ? PETSC_TRUE : PETSC_FALSE;

  PetscCall(PetscCitationsRegister(text, &flag));
  *set = flag ? 1 : 0;
  return 0;
}

int ff_help_print(MPI_Comm comm, const char *text)
{
  return (int)(*PetscHelpPrintf)(comm, "%s", text);
}

int ff_viewer_print(PetscViewer viewer, const char *text)
{
  return (int)PetscViewerASCIIPrintf(viewer, "%s", text);
}

int ff_viewer_is_ascii(PetscViewer viewer, int *ascii)
{
  PetscBool flag = PETSC_FALSE;

  PetscCall(PetscObjectTypeCompare((PetscObject)viewer, PETSCVIEWERASCII, &flag));
  *ascii = flag ? 1 : 0;
  return 0;
}

int ff_options_any(const char *start, PetscBool *found)
{
  char  *text   = NULL;
  size_t length = strlen(start);

  *found = PETSC_FALSE;
  PetscCall(PetscOptionsGetAll(NULL, &text));
  for (const char *at = text; at && *at; ++at) {
    if ((at != text && at[-1] != ' ') || strncmp(at, start, length)) continue;
    *found = PETSC_TRUE;
  }
  return (int)PetscFree(text);
}

int ff_free(void *memory)
{
  return (int)PetscFree(memory);
}
