/*
   Two elastic bodies in contact, from MFEM (serial): every rank assembles its parts of the meshes and hands them over.

     pip install --no-deps --target mfem mfem==4.10.0.1      # for Python 3.11; headers and library are in the wheel
     M=$PWD/mfem/mfem/external/ser
     mpicxx -std=c++17 -I$M/include mfem_contact.cpp -o mfem_contact -L$M/lib -lmfem -Wl,-rpath,$M/lib \
         $(pkg-config --cflags --libs fetifeti) -Wl,-rpath,$(pkg-config --variable=libdir fetifeti)
     mpirun -n 4 ./mfem_contact -fetifeti_ksp_rtol 1e-10

   A block lies on another one with a curved upper side and is pressed down. All ranks know both meshes.
*/
#include "fetifeti.h"
#include "mfem_direct.hpp"

static const int N = 8, NODES = (N + 1) * (N + 1), SIZE = 4 * NODES; // squares along a side, nodes of a body, unknowns

/* Body 0 on the ground or body 1 above it; the attribute of an element is its part, 1 to 4. */
static Mesh Body(int body)
{
  Mesh mesh = Mesh::MakeCartesian2D(N, N, Element::QUADRILATERAL, true, 1.0, 1.0, false);
  for (int e = 0; e < mesh.GetNE(); e++) mesh.SetAttribute(e, 1 + 2 * (e / N >= N / 2) + (e % N >= N / 2));
  mesh.SetAttributes();
  for (int v = 0; v < mesh.GetNV(); v++) {
    double *x = mesh.GetVertex(v);
    x[1] = body ? 1 + x[1] : x[1] * (1 - 0.1 * (x[0] - 0.4) * (x[0] - 0.4));
  }
  return mesh;
}

/* Stiffness without conditions, by node: unknown 2 v + c. */
static SparseMatrix Stiffness(Mesh &mesh)
{
  H1_FECollection     linear(1, 2);
  FiniteElementSpace  space(&mesh, &linear, 2, Ordering::byVDIM);
  ConstantCoefficient one(1.0);
  BilinearForm        a(&space);
  a.AddDomainIntegrator(new ElasticityIntegrator(one, one));
  a.Assemble();
  a.Finalize();
  return SparseMatrix(a.SpMat());
}

int main(int argc, char **argv)
{
  PetscMPIInt rank, size;
  FetiFeti    ff;
  Vec         b, u;
  IS          held, side[2];

  PetscCall(PetscInitialize(&argc, &argv, NULL, NULL));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  Mesh body[2] = {Body(0), Body(1)};
  PetscCall(FetiFetiCreate(PETSC_COMM_WORLD, &ff));
  PetscCall(FetiFetiSetFromOptions(ff));
  PetscCall(FetiFetiSetBlockSize(ff, 2));
  for (int k = rank; k < 8; k += size) {
    Array<int> part(1), dofs;
    part[0] = 1 + k % 4;
    SubMesh      sub = SubMesh::CreateFromDomain(body[k / 4], part);
    SparseMatrix K   = Stiffness(sub);
    for (int v : sub.GetParentVertexIDMap())
      for (int c = 0; c < 2; c++) dofs.Append(2 * (NODES * (k / 4) + v) + c);
    PetscCall(FetiFetiAddSubdomain(ff, k / 4, K.Height(), K.GetI(), K.GetJ(), K.GetData(), dofs));
  }
  Array<int>     lower, upper, fixed; // the first rank gives pairs of unknowns that face each other, and held ones
  Vector         gap(N + 1), force(N + 1), load(SIZE);
  const PetscInt n = rank ? 0 : N + 1;
  load = 0.0;
  for (int i = 0; i <= N; i++) {
    lower.Append(2 * (NODES - N - 1 + i) + 1); // vertical: upper side of body 0, lower side of body 1
    upper.Append(2 * (NODES + i) + 1);
    gap[i] = 1 - body[0].GetVertex(NODES - N - 1 + i)[1];
    for (int d : {2 * i + 1, 2 * i * (N + 1), 2 * (NODES + i * (N + 1))}) fixed.Append(d); // ground, both left sides
    load[2 * (2 * NODES - N - 1 + i) + 1] = -(i % N ? 0.04 : 0.02) / N;
  }
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, lower, PETSC_COPY_VALUES, &side[0]));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, upper, PETSC_COPY_VALUES, &side[1]));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, 3 * n, fixed, PETSC_COPY_VALUES, &held));
  PetscCall(FetiFetiSetContactPairs(ff, PETSC_DECIDE, side[0], PETSC_DECIDE, side[1], gap.GetData(),
                                    FETIFETI_INEQUALITY));
  PetscCall(FetiFetiSetDirichletBoundaries(ff, held, NULL));
  PetscCall(VecCreateMPI(PETSC_COMM_WORLD, PETSC_DECIDE, SIZE, &b));
  for (int i = 0; i < (rank ? 0 : SIZE); i++) PetscCall(VecSetValue(b, i, load[i], INSERT_VALUES));
  PetscCall(VecAssemblyBegin(b));
  PetscCall(VecAssemblyEnd(b));
  PetscCall(VecDuplicate(b, &u));
  PetscCall(FetiFetiSolve(ff, b, u));
  PetscCall(FetiFetiGetMultipliers(ff, n, force.GetData()));

  SparseMatrix K[2] = {Stiffness(body[0]), Stiffness(body[1])};
  PetscCall(Compare(K, u, fixed, lower, upper, gap, force, load));
  PetscCall(VecDestroy(&u));
  PetscCall(VecDestroy(&b));
  for (IS *is : {&held, &side[0], &side[1]}) PetscCall(ISDestroy(is));
  PetscCall(FetiFetiDestroy(&ff));
  PetscCall(PetscFinalize());
  return 0;
}
