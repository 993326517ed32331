/* What differs between PETSc 3.18 and 3.26, for all sources in C: the shim here, and the plug-in in wrappers. */
#if !defined(FETIFETI_COMPAT_H)
#define FETIFETI_COMPAT_H

#include <petscksp.h>

#if PETSC_VERSION_LT(3, 22, 0)
  #define PETSC_CURRENT PETSC_DEFAULT
#endif

#if PETSC_VERSION_GE(3, 23, 0)
typedef PetscOptionItems FFOptionItems;
#else
typedef PetscOptionItems *FFOptionItems;
#endif

#if PETSC_VERSION_GE(3, 24, 0)
  #define FF_OPERATION(f) ((PetscErrorCodeFn *)(f))
#else
  #define FF_OPERATION(f) ((void (*)(void))(f))
#endif

/* The destructor of the context of a test of convergence. */
#if PETSC_VERSION_GE(3, 24, 0)
typedef PetscCtxDestroyFn *FFDropTest;
#else
typedef PetscErrorCode (*FFDropTest)(void *);
#endif

/* Makes a vector one that a norm finds to be wrong: the result of a solver that has failed. Collective. */
static inline PetscErrorCode FFSpoil(Vec x)
{
#if PETSC_VERSION_GE(3, 22, 0)
  return VecFlag(x, PETSC_TRUE);
#else
  return VecSetInf(x);
#endif
}

/* Gives a KSP a DM that its matrices do not come from. */
static inline PetscErrorCode FFLendDM(KSP ksp, DM dm)
{
  PetscCall(KSPSetDM(ksp, dm));
#if PETSC_VERSION_GE(3, 25, 0)
  return KSPSetDMActive(ksp, KSP_DMACTIVE_ALL, PETSC_FALSE);
#else
  return KSPSetDMActive(ksp, PETSC_FALSE);
#endif
}

/* Ties a pointer to a container, which passes it to `drop` when it dies. */
#if PETSC_VERSION_GE(3, 23, 0)
  #define FF_DROP(name, drop, type) \
    static PetscErrorCode name(void **at) \
    { \
      return drop((type *)*at); \
    }
  #define FFContainerSetDrop(container, name) PetscContainerSetCtxDestroy(container, (PetscCtxDestroyFn *)name)
#else
  #define FF_DROP(name, drop, type) \
    static PetscErrorCode name(void *at) \
    { \
      return drop((type *)at); \
    }
  #define FFContainerSetDrop(container, name) PetscContainerSetUserDestroy(container, name)
#endif

/* Whether the map of a MATIS may list a dof several times. */
static inline PetscErrorCode FFIsRepeated(Mat mat, PetscBool *repeated)
{
  *repeated = PETSC_FALSE;
#if PETSC_VERSION_GE(3, 21, 0)
  return MatISGetAllowRepeated(mat, repeated);
#else
  (void)mat;
  return (PetscErrorCode)0;
#endif
}

/* Allows it; an error before PETSc 3.21. */
static inline PetscErrorCode FFAllowRepeated(Mat mat)
{
#if PETSC_VERSION_GE(3, 21, 0)
  return MatISSetAllowRepeated(mat, PETSC_TRUE);
#else
  SETERRQ(PetscObjectComm((PetscObject)mat), PETSC_ERR_SUP, "PETSc has repeated entries of a MATIS from 3.21 on");
#endif
}

#endif
