/*
   FETI-FETI for programs that run on PETSc: FETI-DP inside bodies, one-level FETI between bodies, contact between them.

   Link with libfetifeti.so. All functions return a PETSc error code; errors go through PETSc's error handler as one
   sentence. All ranks of the communicator of FetiFetiCreate() must call a "Collective" function; each rank may call the
   others as often as it likes.
*/
#if !defined(FETIFETI_H)
#define FETIFETI_H

#include <petscksp.h>

#define FETIFETI_VERSION_MAJOR    0
#define FETIFETI_VERSION_MINOR    2
#define FETIFETI_VERSION_SUBMINOR 0
/* Whether the library is at least this version */
#define FETIFETI_VERSION_GE(major, minor, subminor) \
  (FETIFETI_VERSION_MAJOR > (major) || \
   (FETIFETI_VERSION_MAJOR == (major) && \
    (FETIFETI_VERSION_MINOR > (minor) || \
     (FETIFETI_VERSION_MINOR == (minor) && FETIFETI_VERSION_SUBMINOR >= (subminor)))))

/*S
   FetiFeti - A solver for several bodies that are tied or in contact: min 1/2 u'Ku - f'u subject to B u = c, B u <= c

   Level: beginner

   Notes:
   The unknowns of all bodies have one numbering, the numbering of the entries of the right-hand side and the solution.
   Two subdomains of one body share an unknown if both list its number. Two subdomains of different bodies that list the
   same number are tied: one-level FETI between them.

   Matrices that were assembled body by body need no common numbers: see FetiFetiAddMatIS().

.seealso: `FetiFetiCreate()`, `FetiFetiAddMatIS()`, `FetiFetiAddSubdomain()`, `FetiFetiSetContactPairs()`,
          `FetiFetiSetContactRows()`, `FetiFetiAddMortar()`, `FetiFetiSolve()`
S*/
typedef struct _p_FetiFeti *FetiFeti;

/*E
   FetiFetiRowKind - How a row of FetiFetiSetContactRows() or FetiFetiSetContactPairs() holds

   Level: beginner

   Values:
+  FETIFETI_EQUALITY   - (B u)_r = gap_r
-  FETIFETI_INEQUALITY - (B u)_r <= gap_r, with a multiplier that is not negative

.seealso: `FetiFetiSetContactRows()`, `FetiFetiSetContactPairs()`
E*/
#define FETIFETI_EQUALITY   0
#define FETIFETI_INEQUALITY 1

/*E
   FetiFetiRowState - The state of a row of contact after a solve

   Level: beginner

   Values:
+  FETIFETI_OPEN  - the sides are apart
.  FETIFETI_HOLDS - the row holds: an equation, or contact without a force of friction
.  FETIFETI_STICK - in contact, and the sides stick to each other
-  FETIFETI_SLIP  - the sides slide, with the largest force of friction that the law allows

.seealso: `FetiFetiGetContactFriction()`, `FetiFetiGetMortar()`
E*/
#define FETIFETI_OPEN  0
#define FETIFETI_HOLDS 1
#define FETIFETI_STICK 2
#define FETIFETI_SLIP  3

/*@C
   FetiFetiInitializePackage - Registers "fetifeti" as a type of KSP and of PC in a program that links with the library

   Not Collective

   Level: intermediate

   Note:
   Objects of this header need no registration.

.seealso: `KSPFETIFETISetBody()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiInitializePackage(void);

/*@
   KSPFETIFETISetBody - Says which body this rank's subdomain belongs to, for a KSP of type "fetifeti"

   Logically Collective

   Input Parameters:
+  ksp  - the KSP
-  body - ranks with the same number form a body

   Level: intermediate

   Note:
   A rank without rows has no subdomain and need not call. Either all other ranks call, or none. The last of
   KSPFETIFETISetBody(), KSPFETIFETISetBodyIS() and KSPFETIFETISetBodyLabel() counts.

.seealso: `KSPFETIFETISetBodyIS()`, `KSPFETIFETISetBodyLabel()`, `KSPFETIFETIGetInnerKSP()`
@*/
PETSC_EXTERN PetscErrorCode KSPFETIFETISetBody(KSP ksp, PetscInt body);

/*@
   KSPFETIFETISetBodyIS - Says which body each row of the operator belongs to, for a KSP of type "fetifeti"

   Collective

   Input Parameters:
+  ksp    - the KSP
-  bodies - the number of a body for each row of the operator that this rank owns, as MatPartitioningApply() returns it

   Level: intermediate

   Note:
   A subdomain belongs to the body that most of its unknowns name, the lowest of several. The index set is referenced,
   not copied.

.seealso: `KSPFETIFETISetBody()`, `KSPFETIFETISetBodyLabel()`
@*/
PETSC_EXTERN PetscErrorCode KSPFETIFETISetBodyIS(KSP ksp, IS bodies);

/*@
   KSPFETIFETISetBodyLabel - Says that a label of the cells of a DMPlex names the bodies, for a KSP of type "fetifeti"

   Logically Collective

   Input Parameters:
+  ksp  - the KSP
-  name - name of the label

   Options Database Key:
.  -fetifeti_body_label name - the same

   Level: intermediate

   Note:
   The mesh is that of KSPSetDM(), else the one that made the operator (DMCreateMatrix()). The subdomain of a rank
   belongs to the value that most of the rank's cells have, the lowest of several; cells without a value do not count.

.seealso: `KSPFETIFETISetBody()`, `KSPFETIFETISetBodyIS()`
@*/
PETSC_EXTERN PetscErrorCode KSPFETIFETISetBodyLabel(KSP ksp, const char name[]);

/*@
   KSPFETIFETISetPrimalDofs - Makes unknowns primal where subdomains share them, for a KSP of type "fetifeti"

   Collective

   Input Parameters:
+  ksp  - the KSP
-  dofs - global numbers of unknowns, listed by any rank; NULL: only those that the solver chooses

   Level: advanced

   Note:
   The index set is referenced, not copied. As with PCBDDCSetPrimalVerticesIS(), the solver may choose more.

.seealso: `FetiFetiSetPrimalDofs()`
@*/
PETSC_EXTERN PetscErrorCode KSPFETIFETISetPrimalDofs(KSP ksp, IS dofs);

/*@
   KSPFETIFETIGetInnerKSP - Gets the KSP that iterates on the multipliers, of a KSP of type "fetifeti"

   Not Collective

   Input Parameter:
.  ksp - the KSP, after KSPSetUp()

   Output Parameter:
.  inner - its inner KSP, not to be destroyed

   Level: advanced

.seealso: `KSPFETIFETISetBody()`
@*/
PETSC_EXTERN PetscErrorCode KSPFETIFETIGetInnerKSP(KSP ksp, KSP *inner);

/*@
   PCFETIFETIGetKSP - Gets the KSP of type "fetifeti" that a PC of type "fetifeti" applies

   Not Collective

   Input Parameter:
.  pc - the preconditioner

   Output Parameter:
.  ksp - its KSP, not to be destroyed

   Options Database Keys:
+  -pc_fetifeti_ksp_rtol rtol - each application ends when the jumps between subdomains have fallen by this; 1e-2
.  -pc_fetifeti_its n         - each application takes n iterations instead
-  -pc_fetifeti_...           - the options of the method, which a KSP has with -fetifeti_...

   Level: intermediate

   Notes:
   The KSP is for what has no option: KSPFETIFETISetBody() and its like.

   An application is an iteration: the KSP around the PC must be a flexible one (fgmres, gcr, fcg) unless the tolerance
   is far below that of the outer KSP.

.seealso: `KSPFETIFETISetBody()`, `KSPFETIFETIGetInnerKSP()`
@*/
PETSC_EXTERN PetscErrorCode PCFETIFETIGetKSP(PC pc, KSP *ksp);

/*@
   FetiFetiCreate - Creates a solver

   Collective

   Input Parameter:
.  comm - the communicator

   Output Parameter:
.  ff - the solver

   Level: beginner

   Note:
   From Fortran call FetiFetiCreateFortran(), which takes the communicator as Fortran numbers it
   (wrappers/fetifeti.f90).

.seealso: `FetiFetiDestroy()`, `FetiFetiSolve()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiCreate(MPI_Comm comm, FetiFeti *ff);
PETSC_EXTERN PetscErrorCode FetiFetiCreateFortran(int comm, FetiFeti *ff);

/*@
   FetiFetiDestroy - Destroys a solver

   Collective

   Input Parameter:
.  ff - the solver; NULL afterwards

   Level: beginner

   Note:
   To be called before PetscFinalize(). A pointer to NULL is left alone.

.seealso: `FetiFetiCreate()`, `FetiFetiReset()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiDestroy(FetiFeti *ff);

/*@
   FetiFetiReset - Forgets subdomains, rows and everything else but the prefix and what FetiFetiSetFromOptions() read

   Collective

   Input Parameter:
.  ff - the solver

   Level: intermediate

.seealso: `FetiFetiDestroy()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiReset(FetiFeti ff);

/*@
   FetiFetiSetOptionsPrefix - Sets the prefix of all options

   Logically Collective

   Input Parameters:
+  ff     - the solver
-  prefix - the prefix P, without a hyphen, or NULL; options begin with -Pfetifeti_

   Level: intermediate

.seealso: `FetiFetiSetFromOptions()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetOptionsPrefix(FetiFeti ff, const char prefix[]);

/*@
   FetiFetiSetFromOptions - Reads the options of the object itself

   Collective

   Input Parameter:
.  ff - the solver

   Options Database Keys:
+  -fetifeti_bodies <n>    - number of bodies for subdomains that were given none; 0: one for every connected piece
.  -fetifeti_view          - show the solver after set-up
.  -fetifeti_ksp_rtol <r>  - relative tolerance of the iteration; all options of a KSP with this prefix
-  -fetifeti_contact_...   - the contact loop; see docs/options.md

   Level: beginner

   Note:
   The options of the method and of the inner KSP are read by FetiFetiSetUp(), whether or not this function is called.

.seealso: `FetiFetiSetOptionsPrefix()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetFromOptions(FetiFeti ff);

/*@C
   FetiFetiView - Shows bodies, multipliers and what the last solve did

   Collective

   Input Parameters:
+  ff     - the solver
-  viewer - an ASCII viewer; NULL: the standard output of the first rank

   Options Database Key:
.  -fetifeti_view - does this at the end of FetiFetiSetUp(), after FetiFetiSetFromOptions()

   Level: beginner

.seealso: `FetiFetiSetFromOptions()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiView(FetiFeti ff, PetscViewer viewer);

/*@
   FetiFetiSetSizes - Sets the numbers of unknowns of all bodies together, as VecSetSizes() does

   Logically Collective

   Input Parameters:
+  ff - the solver
.  n  - entries of right-hand side and solution on this rank, or PETSC_DECIDE
-  N  - entries on all ranks, or PETSC_DETERMINE

   Level: beginner

   Note:
   Without this function the layout comes from the matrix of FetiFetiSetMatIS(), or from all matrices of
   FetiFetiAddMatIS() without numbers, one after the other on each rank. Otherwise N is one more than the highest number
   of an unknown in a subdomain, and n is that of PETSC_DECIDE.

.seealso: `FetiFetiAddSubdomain()`, `FetiFetiSetBlockSize()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetSizes(FetiFeti ff, PetscInt n, PetscInt N);

/*@
   FetiFetiSetBlockSize - Sets how many consecutive unknowns belong to a node

   Logically Collective

   Input Parameters:
+  ff - the solver
-  bs - the block size; without this function that of the MATIS, or 1

   Level: beginner

   Note:
   Displacements in the plane have block size 2, in space 3. The block size improves the choice of constraints and
   bodies.

.seealso: `FetiFetiSetCoordinates()`, `FetiFetiSetNearNullSpace()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetBlockSize(FetiFeti ff, PetscInt bs);

/*@
   FetiFetiAddSubdomain - Hands over the stiffness matrix of one subdomain

   Not Collective

   Input Parameters:
+  ff   - the solver
.  body - number of the body that it belongs to, or PETSC_DECIDE for all subdomains: a graph partition finds the bodies
.  n    - rows of the matrix
.  ia   - start of each row in ja and a, length n + 1, from 0
.  ja   - columns, in any order; entries at the same place are added up
.  a    - entries
-  dofs - global number of the unknown of each row; a negative one is left out

   Level: beginner

   Notes:
   A rank may call this as often as it likes, or never. The arrays are copied. The matrix is that of the elements of the
   subdomain alone, without the contributions of its neighbours: the sum over all subdomains is the assembled matrix. It
   must be symmetric.

   A row that has only its diagonal in all subdomains is taken as a boundary condition, u = b / diagonal, as
   MatZeroRowsColumns() leaves it. So is an empty row.

   A body whose subdomains are not connected becomes several bodies.

.seealso: `FetiFetiSetMatIS()`, `FetiFetiAddMatIS()`, `FetiFetiSetDirichletBoundaries()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiAddSubdomain(FetiFeti ff, PetscInt body, PetscInt n, const PetscInt ia[],
                                                 const PetscInt ja[], const PetscScalar a[], const PetscInt dofs[]);

/*@
   FetiFetiSetMatIS - Takes the subdomains from a matrix of type MATIS, one on each rank, instead of those given before

   Collective

   Input Parameters:
+  ff   - the solver
.  A    - the matrix
-  body - the body of this rank's subdomain, or PETSC_DECIDE on all ranks

   Level: beginner

   Note:
   The layout of vectors, the block size and the motions (the near-null space, else the null space) come from the
   matrix, too. Entries are copied: after a change of them call FetiFetiUpdateMatrices().

.seealso: `FetiFetiAddMatIS()`, `FetiFetiAddSubdomain()`, `FetiFetiUpdateMatrices()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetMatIS(FetiFeti ff, Mat A, PetscInt body);

/*@
   FetiFetiAddMatIS - Adds the matrix of one body of several that were discretised by themselves

   Collective

   Input Parameters:
+  ff      - the solver
.  A       - the matrix of the body, of type MATIS
.  numbers - NULL: the matrices are numbered one after the other; else for each row of A that this rank owns its number
             among the unknowns of all bodies
-  body    - number of the body, or PETSC_DECIDE for all matrices

   Level: beginner

   Notes:
   Without numbers the unknowns on each rank are its rows of the first matrix, then those of the second, and so on, as
   DMComposite and nested matrices number them. FetiFetiSolve() takes vectors of type VECNEST with a part for each
   matrix. No other function for sizes is needed. The motions of a body that cost no energy are those of
   MatSetNearNullSpace() on its matrix, else of MatSetNullSpace(); where one matrix has neither, the motions of all are
   found from the matrices, or from FetiFetiSetCoordinates().

   With numbers (as DMCompositeGetGlobalISs() gives them) null spaces of A are not looked at: their vectors belong to
   another numbering. Give motions by FetiFetiSetNearNullSpace() or FetiFetiSetCoordinates().

   All matrices of a solver are added in one of the two ways, and FetiFetiAddSubdomain() and FetiFetiSetMatIS() go
   together with numbers only.

   Entries are copied: after a change of them call FetiFetiUpdateMatrices().

.seealso: `FetiFetiSetMatIS()`, `FetiFetiAddSubdomain()`, `FetiFetiSetContactPairs()`, `FetiFetiUpdateMatrices()`,
          `FetiFetiSolve()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiAddMatIS(FetiFeti ff, Mat A, IS numbers, PetscInt body);

/*@
   FetiFetiUpdateMatrices - Takes new entries of the matrices that were added: for Newton's method and load steps

   Collective

   Input Parameters:
+  ff - the solver
.  n  - how many matrices FetiFetiAddMatIS() has added, or 1 after FetiFetiSetMatIS()
-  A  - the matrices in the order in which they were added, the same ones or others with the same maps; NULL for one
        that stays as it was

   Level: intermediate

   Notes:
   The next FetiFetiSetUp() or FetiFetiSolve() keeps bodies, constraints, the interface and all analyses of patterns,
   and factors again. It first looks whether the new entries fit: where an entry is not zero that was exactly zero
   before, a row became a boundary condition or ceased to be one, a subdomain fell apart, or a rigid motion began or
   ceased to cost energy, everything is set up anew. FetiFetiView() says what was done.

   Rows and their multipliers stay: the contact loop starts from them. FetiFetiSetContactRows() and
   FetiFetiSetContactGaps() may be called before the next set-up, too.

.seealso: `FetiFetiAddMatIS()`, `FetiFetiSetMatIS()`, `FetiFetiUpdateSubdomain()`, `FetiFetiSetContactGaps()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiUpdateMatrices(FetiFeti ff, PetscInt n, const Mat A[]);

/*@
   FetiFetiUpdateSubdomain - Takes new entries of a subdomain of FetiFetiAddSubdomain()

   Not Collective

   Input Parameters:
+  ff - the solver
.  s  - which of the subdomains that this rank has added, from 0
.  n  - rows of the matrix, as many as before
.  ia - start of each row in ja and a, length n + 1, from 0
.  ja - columns, in any order; entries at the same place are added up
-  a  - entries

   Level: intermediate

   Note:
   Subdomains that are not updated stay. For what is kept see FetiFetiUpdateMatrices().

.seealso: `FetiFetiAddSubdomain()`, `FetiFetiUpdateMatrices()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiUpdateSubdomain(FetiFeti ff, PetscInt s, PetscInt n, const PetscInt ia[],
                                                    const PetscInt ja[], const PetscScalar a[]);

/*@
   FetiFetiSetNearNullSpace - Gives vectors that span every kernel that a subdomain without boundary conditions may have

   Collective

   Input Parameters:
+  ff    - the solver
-  space - rigid body motions, vectors as FetiFetiSolve() takes them; NULL: those of the matrices, if they have some

   Level: intermediate

   Note:
   Vectors that turn out not to be kernels are not used: then kernels are found from the matrices.

.seealso: `FetiFetiSetCoordinates()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetNearNullSpace(FetiFeti ff, MatNullSpace space);

/*@
   FetiFetiSetCoordinates - Gives the places of the nodes, for rigid body motions where no near-null space is given

   Logically Collective

   Input Parameters:
+  ff     - the solver
.  dim    - 1, 2 or 3
.  n      - nodes whose unknowns are on this rank: entries of the solution over the block size
-  coords - dim numbers for each

   Level: intermediate

   Note:
   Rotations are made where the block size is the dimension, else one constant for each component. Otherwise places are
   not used.

.seealso: `FetiFetiSetNearNullSpace()`, `FetiFetiSetBlockSize()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetCoordinates(FetiFeti ff, PetscInt dim, PetscInt n, const PetscReal coords[]);

/*@
   FetiFetiSetDirichletBoundaries - Holds unknowns at given values

   Collective

   Input Parameters:
+  ff     - the solver
.  dofs   - unknowns, listed by any rank, also by several; NULL: none
-  values - has their values, a vector as FetiFetiSolve() takes it; NULL: zero

   Level: beginner

   Notes:
   As with PCBDDCSetDirichletBoundaries() the unknowns may be listed on any rank. The matrices need not contain the
   conditions: rows and columns of held unknowns are not used. Values are read at each FetiFetiSolve(), and may change
   between solves.

.seealso: `FetiFetiSetNeumannBoundaries()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetDirichletBoundaries(FetiFeti ff, IS dofs, Vec values);

/*@
   FetiFetiSetNeumannBoundaries - Has no effect; it exists for compatibility with PCBDDCSetNeumannBoundaries()

   Collective

   Input Parameters:
+  ff   - the solver
-  dofs - unknowns with natural conditions

   Level: advanced

   Note:
   PCBDDC classifies interface nodes by these unknowns. Here vertices, edges and faces follow from the sets of
   subdomains that share each unknown.

.seealso: `FetiFetiSetDirichletBoundaries()`, `FetiFetiSetPrimalDofs()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetNeumannBoundaries(FetiFeti ff, IS dofs);

/*@
   FetiFetiSetPrimalDofs - Makes unknowns primal where subdomains of one body share them

   Collective

   Input Parameters:
+  ff   - the solver
-  dofs - unknowns, listed by any rank; NULL: only those that the solver chooses

   Level: advanced

.seealso: `FetiFetiAddSubdomain()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetPrimalDofs(FetiFeti ff, IS dofs);

/*@
   FetiFetiSetContactRows - Gives rows (B u)_r = gap_r or (B u)_r <= gap_r: contact, obstacles, equations

   Not Collective

   Input Parameters:
+  ff   - the solver
.  n    - rows that this rank gives, instead of those that it gave before
.  ia   - start of each row in ja and b, length n + 1, from 0
.  ja   - numbers of unknowns
.  b    - coefficients
.  gap  - right-hand sides
-  kind - FETIFETI_EQUALITY or FETIFETI_INEQUALITY, for each row

   Level: beginner

   Notes:
   Each row is given by one rank, any one. For two nodes that face each other with the normal n from the first to the
   second: coefficients n at the first one, -n at the second one, and the distance as gap. A multiplier is then the
   force with which the second one is pressed away.

   A row may have as many terms as it likes. FetiFetiAddMortar() makes the rows of two surfaces.

   Terms at held unknowns go to the right-hand side. A row all of whose unknowns are held has no effect, and a
   multiplier of zero.

   Rows of FetiFetiSetContactPairs() stay.

   Rows may be replaced after a solve. Subdomains that the change does not touch stay factored. A row whose first term
   is at the same node as that of an earlier row of this rank starts from its multiplier.

.seealso: `FetiFetiSetContactRowsByMatrix()`, `FetiFetiSetContactPairs()`, `FetiFetiSetContactGaps()`,
          `FetiFetiSetContactLaw()`, `FetiFetiGetMultipliers()`, `FetiFetiGetKKT()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactRows(FetiFeti ff, PetscInt n, const PetscInt ia[], const PetscInt ja[],
                                                   const PetscScalar b[], const PetscReal gap[], const PetscInt kind[]);

/*@
   FetiFetiSetContactRowsByMatrix - FetiFetiSetContactRows() with numbers of single matrices

   Not Collective

   Input Parameters:
+  ff     - the solver
.  n      - rows that this rank gives, instead of those that it gave before by this function or FetiFetiSetContactRows()
.  ia     - start of each row in matrix, ja and b, length n + 1, from 0
.  matrix - for each term the matrix whose unknown it is, 0 for the first one of FetiFetiAddMatIS() or that of
            FetiFetiSetMatIS(); PETSC_DECIDE: ja has its number among the unknowns of all bodies
.  ja     - numbers of unknowns in their matrices, as the entries of vectors of each matrix are numbered
.  b      - coefficients
.  gap    - right-hand sides
-  kind   - FETIFETI_EQUALITY or FETIFETI_INEQUALITY, for each row

   Level: beginner

   Note:
   Matrices are those that were added without numbers so far. Any rank may name any unknown of any matrix.

.seealso: `FetiFetiSetContactRows()`, `FetiFetiSetContactPairs()`, `FetiFetiSetContactGaps()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactRowsByMatrix(FetiFeti ff, PetscInt n, const PetscInt ia[],
                                                           const PetscInt matrix[], const PetscInt ja[],
                                                           const PetscScalar b[], const PetscReal gap[],
                                                           const PetscInt kind[]);

/*@
   FetiFetiSetContactGaps - Gives new right-hand sides of the rows that this rank gave

   Not Collective

   Input Parameters:
+  ff  - the solver
.  n   - how many rows this rank gave, as for FetiFetiGetMultipliers()
-  gap - the right-hand sides, in the order in which the rows were given

   Level: beginner

   Note:
   Nothing is set up again. Clearances of mortars stay.

.seealso: `FetiFetiSetContactRows()`, `FetiFetiSetContactPairs()`, `FetiFetiUpdateMatrices()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactGaps(FetiFeti ff, PetscInt n, const PetscReal gap[]);

/*@
   FetiFetiSetContactPairs - Gives rows u_first - u_second <= gap, or = gap, for pairs of unknowns that face each other

   Collective

   Input Parameters:
+  ff     - the solver
.  a      - the matrix whose unknowns `first` lists, 0 for the first one of FetiFetiAddMatIS(); PETSC_DECIDE: numbers
            among the unknowns of all bodies
.  first  - unknowns; NULL together with `second`: forgets all pairs that were given before
.  b      - the matrix whose unknowns `second` lists, or PETSC_DECIDE
.  second - unknowns, as many on each rank as in `first`
.  gap    - right-hand sides, one for each pair of this rank; NULL: zero
-  kind   - FETIFETI_EQUALITY or FETIFETI_INEQUALITY

   Level: beginner

   Notes:
   May be called several times: pairs are added to the rows that were given before. Entry r of the one index set on this
   rank belongs to entry r of the other. They may name unknowns of other ranks; each pair is given by one rank. Matrices
   are those that were added without numbers so far, or the one of FetiFetiSetMatIS().

   Two sides of DMDAs, here of one unknown in every node, first in the numbering of the grid:
.vb
   ISCreateStride(comm, rank ? 0 : m, first, step, &side);
   DMDAGetAO(da, &ao);
   AOApplicationToPetscIS(ao, side);
.ve

   Where normals have several components use FetiFetiSetContactRows().

.seealso: `FetiFetiAddMatIS()`, `FetiFetiSetContactRows()`, `FetiFetiSetContactLaw()`, `FetiFetiGetMultipliers()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactPairs(FetiFeti ff, PetscInt a, IS first, PetscInt b, IS second,
                                                    const PetscReal gap[], PetscInt kind);

/*@
   FetiFetiSetContactLaw - Gives friction, and stiffnesses of soft contact, to the rows that this rank gave

   Not Collective

   Input Parameters:
+  ff              - the solver
.  n               - how many rows this rank gave, as for FetiFetiGetMultipliers()
.  friction        - Coulomb's coefficient of each row, 0 without friction; NULL: none has friction by this law
.  limit           - the largest force of friction beside `friction`, PETSC_INFINITY where there is no limit; NULL: none
.  tresca          - a given bound of the force of friction, in place of Coulomb's, whether or not the row touches; 0
                     without friction; NULL: none has
.  stiffness       - the multiplier over the overclosure of soft contact, positive; PETSC_INFINITY where contact is
                     hard; NULL: all are hard
-  stick_stiffness - the force of friction over the slip while the sides stick, positive; PETSC_INFINITY where slip is
                     never elastic; NULL: nowhere

   Level: beginner

   Notes:
   Rows are those given so far, by FetiFetiSetContactRows() and FetiFetiSetContactPairs() in the order of
   FetiFetiGetMultipliers(). They get this law in place of the one that they had; rows that are given later have none.
   Laws belong to inequalities: entries at equations are those of no law (0, PETSC_INFINITY).

   Friction needs displacements: nodes of 2 or 3 consecutive unknowns, the block size, in the numbering of all unknowns.
   The coefficients of a row at one of its nodes give the normal, which is that of all its nodes. The directions along
   which the sides slide are perpendicular to it; they are found here, and forces of friction and slips are vectors in
   the components of the nodes: FetiFetiGetContactFriction().

   Limits, bounds and stiffnesses are those of the row, as its multiplier is: with a normal of length 1 forces, and
   forces per length. What is known per area is multiplied by the area of the node.

   In space no other row may lead to the nodes of a row with friction; FetiFetiSolve() says so otherwise.

   A body that nothing but friction beyond its bound holds is an error of FetiFetiSolve(), which names it.

.seealso: `FetiFetiSetContactRows()`, `FetiFetiSetContactPairs()`, `FetiFetiGetContactFriction()`,
          `FetiFetiNextContactStep()`, `FetiFetiSetMortarLaw()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactLaw(FetiFeti ff, PetscInt n, const PetscReal friction[],
                                                  const PetscReal limit[], const PetscReal tresca[],
                                                  const PetscReal stiffness[], const PetscReal stick_stiffness[]);

/*@
   FetiFetiSetContactSlip - Says where the sides of rows with friction stand without a slip

   Not Collective

   Input Parameters:
+  ff   - the solver
.  n    - how many rows this rank gave, as for FetiFetiGetMultipliers()
.  dim  - components of a vector: 2 or 3, the block size
-  slip - for each row the displacement of the first side from the second one that counts as none, length n * dim; NULL:
          zero

   Level: intermediate

   Notes:
   The slip of a solve is B_t u - B_t s, with s as it is given here and B_t the row along the sides; the part of s along
   the normal does not count. The first side of a row is that of its first term.

   New rows have s = 0. FetiFetiNextContactStep() adds the slip of the last solve to s, this function replaces s. An
   obstacle or a belt that moves by d in a load step drags the sides along: keep s, add d and the slip of
   FetiFetiGetContactFriction() to it before each step, and give it here in place of FetiFetiNextContactStep(). Where
   solves are for increments of displacements, as in Newton's method, s is what remains, as gaps are: s less the
   displacement of the first side from the second one so far. Nothing is set up again.

.seealso: `FetiFetiNextContactStep()`, `FetiFetiGetContactFriction()`, `FetiFetiSetMortarSlip()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetContactSlip(FetiFeti ff, PetscInt n, PetscInt dim, const PetscReal slip[]);

/*@
   FetiFetiNextContactStep - Begins a load step: slips count from where the last solve has ended

   Logically Collective

   Input Parameter:
.  ff - the solver, after FetiFetiSolve()

   Level: beginner

   Notes:
   Friction depends on the way, which load steps follow: solve, take results, call this, set loads, solve. Solves
   without it in between are of one and the same load step. Rows keep their slips as long as they are not given anew,
   and so do mortars until FetiFetiResetMortar(). For new rows at the same places add up what
   FetiFetiGetContactFriction() returns, and give it by FetiFetiSetContactSlip().

   A second call after the same solve has no effect. Nothing is set up again.

.seealso: `FetiFetiSolve()`, `FetiFetiSetContactLaw()`, `FetiFetiSetContactSlip()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiNextContactStep(FetiFeti ff);

/*@
   FetiFetiGetContactFriction - Gets forces of friction, slips and states of the rows that this rank gave

   Not Collective

   Input Parameters:
+  ff  - the solver
.  n   - how many rows this rank gave, as for FetiFetiGetMultipliers()
-  dim - components of a vector, the block size

   Output Parameters:
+  force - for each row the force with which its first side, that of its first term, drags the other one along, in
           components, length n * dim; NULL: not wanted
.  slip  - for each row how far the first side has slid on the other one since the beginning of the load step, without
           the elastic part of a stick stiffness, length n * dim; NULL: not wanted
-  state - FETIFETI_OPEN, FETIFETI_HOLDS, FETIFETI_STICK or FETIFETI_SLIP; NULL: not wanted

   Level: beginner

   Note:
   Vectors are zero for rows without friction. Forces are in the units of multipliers and slips in those of gaps. The
   first side itself gets minus the force, as it gets minus lambda along the normal.

.seealso: `FetiFetiSetContactLaw()`, `FetiFetiNextContactStep()`, `FetiFetiGetMultipliers()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetContactFriction(FetiFeti ff, PetscInt n, PetscInt dim, PetscReal force[],
                                                       PetscReal slip[], PetscInt state[]);

/*@
   FetiFetiAddSurface - Gives a surface of a body by nodes and faces, for FetiFetiAddMortar()

   Collective

   Input Parameters:
+  ff         - the solver
.  matrix     - the matrix whose unknowns `dofs` lists, 0 for the first one of FetiFetiAddMatIS(); PETSC_DECIDE: numbers
                among the unknowns of all bodies
.  dim        - 2 or 3
.  components - unknowns of a node: dim for displacements, 1 for scalars
.  n          - nodes that this rank gives
.  dofs       - the unknowns of each node, node by node, length n * components; a negative one is no unknown, its
                displacement is zero
.  coords     - the places of the nodes, node by node, length n * dim
.  nfaces     - faces that this rank gives
.  start      - start of each face in nodes, length nfaces + 1, from 0
-  nodes      - the nodes of each face, as places in the list of this rank's nodes, from 0

   Output Parameter:
.  surface - number of the surface, from 0; or NULL

   Level: beginner

   Notes:
   Each rank gives the faces that it has, or none. What ranks give is put together: nodes are the same if their unknowns
   are, and a face that several ranks give counts once. A node that is in none of its rank's faces does not count: all
   nodes of a subdomain may be given.

   The number of its nodes says what a face is: in the plane a segment of 2 or 3 nodes (both ends, the middle), in space
   a triangle of 3 or 6 or a quadrilateral of 4, 8 or 9 (the corners around, the middles of the edges from the first
   corner on, the centre). The normal points out of the body: in the plane to the right on the way from the first node
   to the second one, in space towards whoever sees the corners go around anticlockwise. Neighbouring faces that go
   around in opposite ways are an error.

   Arrays are copied.

.seealso: `FetiFetiAddMortar()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiAddSurface(FetiFeti ff, PetscInt matrix, PetscInt dim, PetscInt components,
                                               PetscInt n, const PetscInt dofs[], const PetscReal coords[],
                                               PetscInt nfaces, const PetscInt start[], const PetscInt nodes[],
                                               PetscInt *surface);

/*@
   FetiFetiAddMortar - Ties two surfaces whose meshes need not match, or puts them in contact, by mortar rows

   Collective

   Input Parameters:
+  ff      - the solver
.  first   - the surface that carries the multipliers, the finer or the softer one by preference
.  second  - the other surface
.  kind    - FETIFETI_EQUALITY: a tie, the displacements of both are equal; FETIFETI_INEQUALITY: contact, whose
             friction FetiFetiSetMortarLaw() gives
.  reach   - how far along the normals of the first surface the second one may be; 0: a few edges
.  adjust  - initial distances and overlaps up to this one count as none; nodes are not moved
.  gap     - a clearance in addition to the distance of the places, negative for an interference
.  gaps    - more of it at each node that this rank gave of the first surface; NULL: none
-  without - for each of these nodes, other than 0 where it is to carry no multiplier; NULL: found alone

   Output Parameter:
.  mortar - number of the mortar, from 0; or NULL

   Level: beginner

   Notes:
   All but the arrays is the same on all ranks. May be called several times, also for surfaces of other mortars; rows of
   FetiFetiSetContactRows() and FetiFetiSetContactPairs() stay.

   The row of node p is sum_k D_pk/D_p n.u_k - sum_q M_pq/D_p n.u_q <= g_p with the dual basis of the first surface and
   its normal n, the mean over the faces around the node. A tie has a row for each component, a scalar has no normal.
   g_p is the distance along n as the row sees it, plus the clearance; for scalars and ties the clearance alone, and a
   tie of vectors has none.

   A node carries no multiplier if it does not lie opposite the second surface, if its unknowns (in contact those along
   n) are held, if it carries multipliers of a mortar that is a tie, or if FetiFetiSetContactPairs() ties it; the
   functions of its neighbours reach over it. Ties come before contacts, in the order in which they were added. A side
   with given values, or with ties of its own, had better be the second one. -fetifeti_view shows how many nodes carry
   multipliers.

   Surfaces that do not face each other are an error, which says if they would with one of them the other way round.
   That the faces of both are the wrong way round cannot be seen where they touch.

   Rows are those of the places at this call: for large sliding call FetiFetiResetMortar() and add surfaces with new
   places.

.seealso: `FetiFetiAddSurface()`, `FetiFetiSetMortarLaw()`, `FetiFetiGetMortar()`, `FetiFetiResetMortar()`,
          `FetiFetiSetContactRows()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiAddMortar(FetiFeti ff, PetscInt first, PetscInt second, PetscInt kind,
                                              PetscReal reach, PetscReal adjust, PetscReal gap, const PetscReal gaps[],
                                              const PetscInt without[], PetscInt *mortar);

/*@
   FetiFetiSetMortarLaw - Gives friction, and stiffnesses of soft contact, to a mortar in contact

   Collective

   Input Parameters:
+  ff              - the solver
.  mortar          - number of the mortar
.  friction        - Coulomb's coefficient; 0 without it
.  limit           - the largest shear stress beside `friction`; PETSC_INFINITY: no limit
.  tresca          - a given bound of the shear stress, in place of Coulomb's, whether or not the sides touch; 0 without
                     it
.  stiffness       - the pressure over the overclosure of soft contact, positive; PETSC_INFINITY: contact is hard
-  stick_stiffness - the shear stress over the slip while the sides stick, positive; PETSC_INFINITY: slip is never
                     elastic

   Level: beginner

   Notes:
   All is the same on all ranks, and takes the place of the law that the mortar had. Bounds and stiffnesses are per
   area: each node has its part by the area of its function.

.seealso: `FetiFetiAddMortar()`, `FetiFetiGetMortarFriction()`, `FetiFetiSetMortarSlip()`, `FetiFetiNextContactStep()`,
          `FetiFetiSetContactLaw()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetMortarLaw(FetiFeti ff, PetscInt mortar, PetscReal friction, PetscReal limit,
                                                 PetscReal tresca, PetscReal stiffness, PetscReal stick_stiffness);

/*@
   FetiFetiSetMortarSlip - Says where the sides of a mortar with friction stand without a slip

   Collective

   Input Parameters:
+  ff     - the solver
.  mortar - number of the mortar
.  n      - nodes that this rank gave of the first surface
-  slip   - for each of these nodes the displacement of the first surface from the second one that counts as none, in
            components, length n * components; NULL: this rank says nothing

   Level: intermediate

   Notes:
   This is FetiFetiSetContactSlip() for surfaces: the slip of a solve is the mean of u_first - u_second that the row
   at a node takes, less s as it is given here, along the surface. A surface that is dragged along by d in a load step
   has d and the slip of FetiFetiGetMortarFriction() added to s before the step, in place of
   FetiFetiNextContactStep().

   Ranks that gave the same node say the same of it. A node of which no rank says anything has s = 0. Nothing is set up
   again.

.seealso: `FetiFetiSetMortarLaw()`, `FetiFetiGetMortarFriction()`, `FetiFetiNextContactStep()`,
          `FetiFetiSetContactSlip()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetMortarSlip(FetiFeti ff, PetscInt mortar, PetscInt n, const PetscReal slip[]);

/*@
   FetiFetiGetMortar - Gets the result of a mortar at the nodes of its first surface

   Not Collective

   Input Parameters:
+  ff     - the solver
.  mortar - number of the mortar
-  n      - nodes that this rank gave of the first surface

   Output Parameters:
+  lambda   - multipliers, forces of the first surface on the second one along n in contact, else by component; NULL:
              not wanted
.  pressure - lambda over the area of the node's function: a pressure (a traction in ties)
.  gap      - what remains of the gap; PETSC_INFINITY at a node without a multiplier
-  state    - FETIFETI_OPEN, FETIFETI_HOLDS, FETIFETI_STICK or FETIFETI_SLIP; -1 at a node without a multiplier

   Level: beginner

   Note:
   One number for each node, in the order of FetiFetiAddSurface(); lambda and pressure of a tie have one for each
   component. Nodes without multipliers have 0. Every rank that gave a node gets its result. In the plane areas are
   lengths: lambda is a force per unit of thickness.

.seealso: `FetiFetiAddMortar()`, `FetiFetiGetMortarFriction()`, `FetiFetiGetMultipliers()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetMortar(FetiFeti ff, PetscInt mortar, PetscInt n, PetscReal lambda[],
                                              PetscReal pressure[], PetscReal gap[], PetscInt state[]);

/*@
   FetiFetiGetMortarFriction - Gets forces of friction and slips of a mortar at the nodes of its first surface

   Not Collective

   Input Parameters:
+  ff     - the solver
.  mortar - number of the mortar
-  n      - nodes that this rank gave of the first surface

   Output Parameters:
+  force - the force with which the first surface drags the second one along at each node, in components; NULL: not
           wanted
.  shear - the force over the area of the node's function, a shear stress, in components; NULL: not wanted
-  slip  - how far the first surface has slid on the second one since the beginning of the load step, without the
           elastic part of a stick stiffness, in components; NULL: not wanted

   Level: beginner

   Note:
   A vector for each node, in the order of FetiFetiAddSurface(), zero without friction. States are those of
   FetiFetiGetMortar().

.seealso: `FetiFetiSetMortarLaw()`, `FetiFetiSetMortarSlip()`, `FetiFetiGetMortar()`, `FetiFetiNextContactStep()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetMortarFriction(FetiFeti ff, PetscInt mortar, PetscInt n, PetscReal force[],
                                                      PetscReal shear[], PetscReal slip[]);

/*@
   FetiFetiResetMortar - Forgets surfaces and mortars; everything else stays

   Collective

   Input Parameter:
.  ff - the solver

   Level: intermediate

   Note:
   For surfaces with new places. Results of the last solve are gone, too.

.seealso: `FetiFetiAddMortar()`, `FetiFetiReset()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiResetMortar(FetiFeti ff);

/*S
   FetiFetiContactStep - A step of the contact loop, as FetiFetiContactMonitorSet() shows it

   Level: intermediate

   Values:
+  step       - number of the step in this solve, from 0
.  active     - rows that held, over all ranks: inequalities and equations
.  entered    - inequalities that hold now and did not before
.  left       - inequalities that held and do not now
.  wrong      - inequalities that are violated at the end of the step, or hold with a multiplier that pulls, and nodes
                with friction that go from sticking to slipping, or back
.  iterations - Krylov iterations
.  residual   - residual at the end of the step, relative to the reference
-  tolerance  - tolerance of the step

.seealso: `FetiFetiContactMonitorSet()`
S*/
typedef struct {
  PetscInt  step, active, entered, left, wrong, iterations;
  PetscReal residual, tolerance;
} FetiFetiContactStep;

/* A function that is called after each step, with what it was set with. */
typedef PetscErrorCode (*FetiFetiContactMonitor)(const FetiFetiContactStep *step, void *ctx);

/*@C
   FetiFetiContactMonitorSet - Sets a function that is called after each step of the contact loop

   Logically Collective

   Input Parameters:
+  ff      - the solver
.  monitor - the function, called on all ranks; NULL: none
-  ctx     - what it is called with

   Level: intermediate

   Note:
   The function must not call functions on ff. A code other than 0 ends the solve with this error.

.seealso: `FetiFetiSolve()`, `FetiFetiGetContactSteps()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiContactMonitorSet(FetiFeti ff, FetiFetiContactMonitor monitor, void *ctx);

/*@
   FetiFetiSetUp - Finds bodies, interfaces and constraints, and factors

   Collective

   Input Parameter:
.  ff - the solver

   Level: intermediate

   Note:
   FetiFetiSolve() does this if it has not been done since something was set on any rank. After new rows or new entries
   of matrices only what they change is set up.

.seealso: `FetiFetiSolve()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSetUp(FetiFeti ff);

/*@
   FetiFetiSolve - Solves

   Collective

   Input Parameters:
+  ff - the solver
-  b  - the right-hand side, assembled over all subdomains

   Output Parameter:
.  x - the solution; its entries on input are ignored

   Options Database Keys:
+  -fetifeti_ksp_rtol <r>                      - relative tolerance of the iteration, and all other options of a KSP
.  -fetifeti_ksp_monitor                       - show the residuals
-  -fetifeti_contact_type <active_set, smalbe> - the contact loop; see docs/options.md for this and the rest

   Level: beginner

   Notes:
   With matrices of FetiFetiAddMatIS() without numbers vectors may be of type VECNEST, with a part for each matrix.

   A solve that follows another one with inequalities starts from its multipliers. An iteration that stops early is no
   error: see FetiFetiGetConvergedReason(). Contradictory rows, and a floating body whose load no row balances, are
   errors.

.seealso: `FetiFetiGetConvergedReason()`, `FetiFetiGetKKT()`, `FetiFetiGetMultipliers()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiSolve(FetiFeti ff, Vec b, Vec x);

/*@
   FetiFetiGetIterations - Gets the number of Krylov iterations of the last solve, over all steps of the contact loop

   Not Collective

   Input Parameter:
.  ff - the solver

   Output Parameter:
.  its - iterations

   Level: beginner

.seealso: `FetiFetiGetContactSteps()`, `FetiFetiGetConvergedReason()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetIterations(FetiFeti ff, PetscInt *its);

/*@
   FetiFetiGetContactSteps - Gets the number of steps of the contact loop in the last solve; 0 without inequalities

   Not Collective

   Input Parameter:
.  ff - the solver

   Output Parameter:
.  steps - steps

   Level: intermediate

.seealso: `FetiFetiGetIterations()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetContactSteps(FetiFeti ff, PetscInt *steps);

/*@
   FetiFetiGetConvergedReason - Gets why the last solve ended

   Not Collective

   Input Parameter:
.  ff - the solver

   Output Parameter:
.  reason - positive where everything reached its tolerance, or rounding where that is larger; negative otherwise

   Level: beginner

.seealso: `FetiFetiGetKKT()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetConvergedReason(FetiFeti ff, KSPConvergedReason *reason);

/*@
   FetiFetiGetSpectrum - Gets the extreme eigenvalues of the preconditioned operator as the last iteration saw them

   Not Collective

   Input Parameter:
.  ff - the solver

   Output Parameters:
+  min - the smallest one, 0 where nothing was iterated
-  max - the largest one

   Level: intermediate

.seealso: `FetiFetiGetIterations()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetSpectrum(FetiFeti ff, PetscReal *min, PetscReal *max);

/*@
   FetiFetiGetKKT - Gets how well the last solution satisfies the optimality conditions

   Not Collective

   Input Parameter:
.  ff - the solver

   Output Parameter:
.  kkt - stationarity |K u - f + B'l| / (|f| + |B'l|), the largest violation of a row over the largest |u|, the largest
         |l_r (B u - c)_r| over max |l| max |u|, the smallest multiplier of an inequality over max |l|

   Level: beginner

.seealso: `FetiFetiGetConvergedReason()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetKKT(FetiFeti ff, PetscReal kkt[4]);

/*@
   FetiFetiGetMultipliers - Gets the multipliers of the rows that this rank gave

   Not Collective

   Input Parameters:
+  ff - the solver
-  n  - how many rows this rank gave, by FetiFetiSetContactRows() and FetiFetiSetContactPairs(); those of mortars do not
        count

   Output Parameter:
.  lambda - the multipliers, in the order in which the rows were given: K u + B'lambda = f

   Level: beginner

.seealso: `FetiFetiSetContactRows()`, `FetiFetiSetContactPairs()`, `FetiFetiGetMortar()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetMultipliers(FetiFeti ff, PetscInt n, PetscReal lambda[]);

/*@
   FetiFetiGetInnerKSP - Gets the KSP that iterates on the multipliers

   Not Collective

   Input Parameter:
.  ff - the solver, after FetiFetiSetUp()

   Output Parameter:
.  ksp - the KSP, not to be destroyed

   Level: advanced

   Note:
   Tolerances and monitors may be set. A new set-up makes a new KSP.

.seealso: `FetiFetiSetUp()`
@*/
PETSC_EXTERN PetscErrorCode FetiFetiGetInnerKSP(FetiFeti ff, KSP *ksp);

#endif
