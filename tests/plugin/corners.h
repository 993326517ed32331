/* What solvers may want to know of the nodes: where they are, and which hold two parts to each other. */
#include "parts.h"

/* The position of every unknown of this rank: PCBDDC picks vertices by them. */
static PetscErrorCode Positions(const Problem *p, Vec u, PC pc)
{
  PetscInt   first, last, c, d, k, bs = p->components, dim = p->mesh.dim;
  PetscReal *x;

  PetscFunctionBeginUser;
  PetscCall(VecGetOwnershipRange(u, &first, &last));
  PetscCall(PetscMalloc1((last - first) * dim + 1, &x));
  for (c = 0; c < p->mesh.nodes; c++)
    for (d = 0; d < bs; d++)
      for (k = 0; k < dim; k++) {
        PetscInt dof = p->number[c] * bs + d;

        if (p->number[c] >= 0 && dof >= first && dof < last) x[(dof - first) * dim + k] = p->mesh.x[3 * c + k];
      }
  PetscCall(PCSetCoordinates(pc, dim, last - first, x));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(0);
}

typedef struct {
  int pair, node; /* the number of a pair of parts that share the node */
} Shared;

static int ByPair(const void *a, const void *b)
{
  const Shared *s = (const Shared *)a, *t = (const Shared *)b;

  return s->pair != t->pair ? (s->pair > t->pair) - (s->pair < t->pair) : (s->node > t->node) - (s->node < t->node);
}

/* The node of a list that is farthest from the line through a and b; from a if they are the same. */
static int Farthest(const Mesh *mesh, const Shared *list, int n, int a, int b)
{
  PetscReal most = -1;
  int       best = a, i, d;

  for (i = 0; i < n; i++) {
    PetscReal along = 0, length = 0, square = 0;

    for (d = 0; d < 3; d++) {
      PetscReal x = mesh->x[3 * list[i].node + d] - mesh->x[3 * a + d], t = mesh->x[3 * b + d] - mesh->x[3 * a + d];

      along += x * t;
      length += t * t;
      square += x * x;
    }
    if (length > 0) square -= along * along / length;
    if (square > most) most = square, best = list[i].node;
  }
  return best;
}

/* The unknowns that hold two parts to each other: at nodes that two parts share alone, three that are far apart. PCBDDC
   finds them itself (-pc_bddc_corner_selection) where each rank has one subdomain. */
static PetscErrorCode Corners(const Problem *p, IS *corners)
{
  const Mesh *mesh = &p->mesh;
  int        *first, *second, *more, v, i, j, n = 0;
  Shared     *shared;
  PetscInt   *dofs, bs = p->components, c, count = 0;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc5(mesh->nodes, &first, mesh->nodes, &second, mesh->nodes, &more, mesh->nodes, &shared,
                         3 * bs * mesh->nodes, &dofs));
  for (i = 0; i < mesh->nodes; i++) first[i] = second[i] = -1, more[i] = 0;
  for (c = 0; c < mesh->cells; c++)
    for (v = 0; v < Vertices(mesh); v++) {
      int node = mesh->cell[c * Vertices(mesh) + v], part = p->part[c];

      if (first[node] < 0 || first[node] == part) first[node] = part;
      else if (second[node] < 0 || second[node] == part) second[node] = part;
      else more[node] = 1;
    }
  for (i = 0; i < mesh->nodes; i++)
    if (second[i] >= 0 && !more[i] && p->number[i] >= 0) {
      int low = PetscMin(first[i], second[i]), high = PetscMax(first[i], second[i]);

      shared[n].pair   = low * (int)p->parts + high;
      shared[n++].node = i;
    }
  qsort(shared, n, sizeof(*shared), ByPair);
  for (i = 0; i < n; i = j) {
    int a, b, pick[3];

    for (j = i; j < n && shared[j].pair == shared[i].pair; j++);
    a       = Farthest(mesh, shared + i, j - i, shared[i].node, shared[i].node);
    b       = Farthest(mesh, shared + i, j - i, a, a);
    pick[0] = a;
    pick[1] = b;
    pick[2] = Farthest(mesh, shared + i, j - i, a, b);
    for (v = 0; v < mesh->dim; v++)
      for (c = 0; c < bs; c++) dofs[count++] = p->number[pick[v]] * bs + c;
  }
  PetscCall(PetscSortRemoveDupsInt(&count, dofs));
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, count, dofs, PETSC_COPY_VALUES, corners));
  PetscCall(PetscFree5(first, second, more, shared, dofs));
  PetscFunctionReturn(0);
}
