/* Makes the types of KSP and PC known to PETSc, if this PETSc is the one that the library was built for. */
#include "kspfetifeti.h"

/* The PETSc that runs may be another one than this file was compiled against: nothing here may depend on its types. */
static PetscErrorCode Suits(void)
{
  /* -1 in both halves: a PETSc with 64-bit indices overwrites both, one with 32-bit indices the first */
  union
  {
    PetscInt64 both;
    int        half[2];
  } major = {-1}, minor = {-1};
  const int     own    = 8 * (int)sizeof(PetscInt);
  PetscDataType scalar = PETSC_DATATYPE_UNKNOWN;
  PetscBool     found;
  int           bits;

  PetscFunctionBegin;
  PetscCall(PetscGetVersionNumber((PetscInt *)major.half, (PetscInt *)minor.half, NULL, NULL));
  bits = major.half[1] == -1 ? 32 : 64;
  PetscCheck(bits == own, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "libfetifeti.so was built for a PETSc with %d-bit indices, this one has %d-bit indices: "
             "load it into a PETSc with %d-bit indices, or build it again for this one",
             own, bits, own);
  PetscCheck(major.half[0] == PETSC_VERSION_MAJOR && minor.half[0] == PETSC_VERSION_MINOR, PETSC_COMM_SELF,
             PETSC_ERR_SUP,
             "libfetifeti.so was built for PETSc %d.%d, this is PETSc %d.%d: build it again for this one",
             PETSC_VERSION_MAJOR, PETSC_VERSION_MINOR, (int)major.half[0], (int)minor.half[0]);
  PetscCall(PetscDataTypeFromString("scalar", &scalar, &found));
  PetscCheck(scalar == PETSC_SCALAR, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "libfetifeti.so was built for a PETSc with real double scalars, this one has %s: "
             "load it into a PETSc with real scalars",
             scalar == PETSC_COMPLEX ? "complex scalars" : "others");
  PetscFunctionReturn(0);
}

/* This file is compiled for any processor. */
int ff_processor_suits(void)
{
#if defined(__x86_64__)
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
         __builtin_cpu_supports("bmi2");
#else
  return 1;
#endif
}

int ff_processor(int avx2)
{
  PetscFunctionBegin;
  PetscCheck(!avx2 || ff_processor_suits(), PETSC_COMM_SELF, PETSC_ERR_SUP,
             "libfetifeti.so was built for processors with AVX2 and FMA, which this one lacks: "
             "build it again with RUSTFLAGS=\"-C target-cpu=x86-64\"");
  PetscFunctionReturn(0);
}

int ff_plugin_register(int avx2)
{
  PetscFunctionBegin;
  PetscCall((PetscErrorCode)ff_processor(avx2));
  PetscCall(Suits());
  PetscCall(KSPRegister("fetifeti", KSPCreate_FETIFETI));
  PetscCall(PCRegister("fetifeti", PCCreate_FETIFETI));
  PetscFunctionReturn(0);
}
