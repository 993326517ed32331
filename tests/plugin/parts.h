/* A box of triangles or tetrahedra that is cut into parts: a Laplacian or elasticity, held where x = 0. */
#include "simplices.h"
#ifdef WITH_METIS
  #include <metis.h>
#endif

typedef struct {
  Mesh       mesh;
  PetscInt   components, parts;
  PetscReal *factor; /* of each cell's stiffness */
  int       *part;   /* of each cell */
  int       *number; /* of each node, -1 where it is held */
  int        free;   /* nodes that are not held */
} Problem;

/* The parts of a regular grid of boxes. */
static void Boxes(const Mesh *mesh, const int n[3], const PetscInt box[3], int *part)
{
  int per = mesh->dim == 2 ? 2 : 6, c, d;

  for (c = 0; c < mesh->cells; c++) {
    int cube = c / per, at[3] = {0, 0, 0};

    for (d = 0; d < mesh->dim; d++) {
      at[d] = (int)(cube % n[d] * box[d] / n[d]);
      cube /= n[d];
    }
    part[c] = (int)(at[0] + box[0] * (at[1] + box[1] * at[2]));
  }
}

/* The parts of METIS, which cuts along sides. */
static PetscErrorCode Metis(const Mesh *mesh, PetscInt parts, int *part)
{
  PetscFunctionBeginUser;
#ifdef WITH_METIS
  {
    idx_t m = mesh->dim + 1, cells = mesh->cells, nodes = mesh->nodes, common = mesh->dim, count = parts, cut, c;
    idx_t *start, *of_cell, *of_node, *vertices;

    PetscCall(PetscMalloc4(cells + 1, &start, cells, &of_cell, nodes, &of_node, m * cells, &vertices));
    for (c = 0; c <= cells; c++) start[c] = m * c;
    for (c = 0; c < m * cells; c++) vertices[c] = mesh->cell[c];
    PetscCheck(METIS_PartMeshDual(&cells, &nodes, start, vertices, NULL, NULL, &common, &count, NULL, NULL, &cut,
                                  of_cell, of_node) == METIS_OK,
               PETSC_COMM_SELF, PETSC_ERR_LIB, "METIS made no parts");
    for (c = 0; c < cells; c++) part[c] = (int)of_cell[c];
    PetscCall(PetscFree4(start, of_cell, of_node, vertices));
  }
#else
  SETERRQ(PETSC_COMM_SELF, PETSC_ERR_SUP, "-metis: this program was built without METIS");
#endif
  PetscFunctionReturn(0);
}

/* The mesh, its parts and its coefficients, from the options. -ring: a quarter of a ring, held where it begins. */
static PetscErrorCode Make(Problem *p)
{
  PetscInt  given[3] = {8, 8, 8}, box[3] = {2, 2, 2}, dim = 3, three = 3, metis = 0, c, d;
  PetscReal shake = 0, vary = 0;
  PetscBool elastic = PETSC_FALSE, ring = PETSC_FALSE;
  int       n[3];

  PetscFunctionBeginUser;
  PetscCall(PetscOptionsGetIntArray(NULL, NULL, "-n", given, &dim, NULL));
  if (dim < 2) dim = 3;
  PetscCall(PetscOptionsGetIntArray(NULL, NULL, "-box", box, &three, NULL));
  PetscCall(PetscOptionsGetInt(NULL, NULL, "-metis", &metis, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-elastic", &elastic, NULL));
  PetscCall(PetscOptionsGetBool(NULL, NULL, "-ring", &ring, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-shake", &shake, NULL));
  PetscCall(PetscOptionsGetReal(NULL, NULL, "-vary", &vary, NULL));
  if (dim == 2) given[2] = box[2] = 1;
  for (d = 0; d < 3; d++) n[d] = (int)given[d];
  random_state  = 5;
  p->components = elastic ? dim : 1;
  PetscCall(Cubes((int)dim, n, &p->mesh));
  for (c = 0; c < p->mesh.nodes; c++)
    for (d = 0; d < dim; d++) {
      PetscReal *x = p->mesh.x + 3 * c + d, by = shake * (Unit() - 0.5);

      if (*x > 0 && *x < n[d]) *x += by;
    }
  for (c = 0; ring && c < p->mesh.nodes; c++) {
    PetscReal *x = p->mesh.x + 3 * c, r = n[0] + x[0], angle = PETSC_PI / 2 * x[1] / n[1];

    x[0] = r * PetscSinReal(angle);
    x[1] = -r * PetscCosReal(angle);
  }
  PetscCall(PetscMalloc1(p->mesh.cells, &p->part));
  PetscCall(PetscMalloc1(p->mesh.cells, &p->factor));
  PetscCall(PetscMalloc1(p->mesh.nodes, &p->number));
  if (metis) PetscCall(Metis(&p->mesh, metis, p->part));
  else Boxes(&p->mesh, n, box, p->part);
  p->parts = metis ? metis : box[0] * box[1] * box[2];
  for (c = 0; c < p->mesh.cells; c++) p->factor[c] = 1 + vary * Unit();
  for (c = p->free = 0; c < p->mesh.nodes; c++) p->number[c] = p->mesh.x[3 * c] > 0 ? p->free++ : -1;
  PetscFunctionReturn(0);
}

/* Adds a cell's stiffness; `local` has the place of each free node, NULL: its number. */
static PetscErrorCode AddCell(const Problem *p, int c, const PetscInt *local, Mat A)
{
  int         m = Vertices(&p->mesh), bs = (int)p->components, v, i;
  PetscInt    dofs[12];
  PetscScalar k[144];

  PetscFunctionBeginUser;
  Stiffness(&p->mesh, c, bs, k);
  for (i = 0; i < m * bs * m * bs; i++) k[i] *= p->factor[c];
  for (v = 0; v < m; v++)
    for (i = 0; i < bs; i++) {
      int node = p->number[p->mesh.cell[c * m + v]];

      dofs[v * bs + i] = node < 0 ? -1 : (local ? local[node] : node) * bs + i;
    }
  PetscCall(MatSetValues(A, m * bs, dofs, m * bs, dofs, k, ADD_VALUES));
  PetscFunctionReturn(0);
}

/* The matrix of the parts first <= part < last, and its nodes in ascending order; with `apart`, every part has copies
   of its own, one part after the other. */
static PetscErrorCode Local(const Problem *p, PetscInt first, PetscInt last, PetscBool apart, Mat *A, PetscInt *count,
                            PetscInt **nodes)
{
  const Mesh *mesh   = &p->mesh;
  PetscInt    groups = apart ? last - first : 1, bs = p->components, c, v, g, *local, *start, *cells, *begin, *list;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc4(mesh->nodes, &local, mesh->cells, &cells, groups + 1, &begin, Vertices(mesh) * mesh->cells,
                         &list));
  PetscCall(PetscCalloc1(groups + 2, &start));
  for (c = 0; c < mesh->cells; c++)
    if (p->part[c] >= first && p->part[c] < last) start[(apart ? p->part[c] - first : 0) + 2]++;
  for (g = 0; g <= groups; g++) start[g + 1] += start[g];
  for (c = 0; c < mesh->cells; c++)
    if (p->part[c] >= first && p->part[c] < last) cells[start[(apart ? p->part[c] - first : 0) + 1]++] = c;
  for (c = 0; c < mesh->nodes; c++) local[c] = -1;
  for (g = begin[0] = 0; g < groups; g++) {
    PetscInt n = begin[g];

    for (c = start[g]; c < start[g + 1]; c++)
      for (v = 0; v < Vertices(mesh); v++) {
        int node = p->number[mesh->cell[cells[c] * Vertices(mesh) + v]];

        if (node < 0 || local[node] == g) continue;
        local[node] = g;
        list[n++]   = node;
      }
    PetscCall(PetscSortInt(n - begin[g], list + begin[g]));
    begin[g + 1] = n;
  }
  *count = begin[groups];
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, *count * bs, *count * bs, (mesh->dim == 2 ? 9 : 30) * bs, NULL, A));
  PetscCall(MatSetBlockSize(*A, bs));
  for (g = 0; g < groups; g++) {
    for (c = begin[g]; c < begin[g + 1]; c++) local[list[c]] = c;
    for (c = start[g]; c < start[g + 1]; c++) PetscCall(AddCell(p, (int)cells[c], local, *A));
  }
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(PetscMalloc1(*count, nodes));
  PetscCall(PetscArraycpy(*nodes, list, *count));
  PetscCall(PetscFree4(local, cells, begin, list));
  PetscCall(PetscFree(start));
  PetscFunctionReturn(0);
}

/* Numbers of this rank: of `all` things a share of about the same size. */
static void Share(PetscInt all, PetscInt *first, PetscInt *last)
{
  PetscMPIInt rank, size;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  *first = all * rank / size;
  *last  = all * (rank + 1) / size;
}
