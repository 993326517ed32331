/* Random simplicial meshes, their partitions and the element matrices of linear functions, for test programs. */
#include <petscksp.h>
#include <stdint.h>

typedef struct {
  int        dim, nodes, cells;
  PetscReal *x;    /* coordinates, 3 for each node */
  int       *cell; /* dim + 1 nodes for each cell */
} Mesh;

/* SplitMix64: the same numbers everywhere. */
static uint64_t random_state;

static uint64_t Bits(void)
{
  uint64_t z = (random_state += 0x9e3779b97f4a7c15u);

  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

static int Below(int n)
{
  return (int)(Bits() % (uint64_t)n);
}

static PetscReal Unit(void)
{
  return (PetscReal)(Bits() >> 11) / 9007199254740992.0;
}

static int Vertices(const Mesh *mesh)
{
  return mesh->dim + 1;
}

/* n[0] x n[1] (x n[2]) cubes of two triangles or six tetrahedra each. */
static PetscErrorCode Cubes(int dim, const int n[3], Mesh *mesh)
{
  /* Paths from corner 0 to the opposite one; bit d of a corner is its place in direction d. */
  static const int plane[2][3] = {{0, 1, 3}, {0, 2, 3}};
  static const int space[6][4] = {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}};
  int              nz = dim == 3 ? n[2] : 0, per = dim == 3 ? 6 : 2, i, j, k, c, v, at = 0;

  PetscFunctionBeginUser;
  mesh->dim   = dim;
  mesh->nodes = (n[0] + 1) * (n[1] + 1) * (nz + 1);
  mesh->cells = n[0] * n[1] * (dim == 3 ? n[2] : 1) * per;
  PetscCall(PetscMalloc1(3 * mesh->nodes, &mesh->x));
  PetscCall(PetscMalloc1((dim + 1) * mesh->cells, &mesh->cell));
  for (k = 0; k <= nz; k++)
    for (j = 0; j <= n[1]; j++)
      for (i = 0; i <= n[0]; i++) {
        PetscReal *x = mesh->x + 3 * (i + (n[0] + 1) * (j + (n[1] + 1) * k));

        x[0] = i;
        x[1] = j;
        x[2] = k;
      }
  for (k = 0; k < (dim == 3 ? n[2] : 1); k++)
    for (j = 0; j < n[1]; j++)
      for (i = 0; i < n[0]; i++)
        for (c = 0; c < per; c++)
          for (v = 0; v <= dim; v++) {
            int corner = dim == 3 ? space[c][v] : plane[c][v];

            int y = j + (corner >> 1 & 1), z = k + (corner >> 2);

            mesh->cell[at++] = i + (corner & 1) + (n[0] + 1) * (y + (n[1] + 1) * z);
          }
  PetscFunctionReturn(0);
}

static PetscReal Length(const Mesh *mesh, int a, int b)
{
  PetscReal sum = 0;
  int       d;

  for (d = 0; d < 3; d++) sum += PetscSqr(mesh->x[3 * a + d] - mesh->x[3 * b + d]);
  return PetscSqrtReal(sum);
}

static PetscBool Has(const Mesh *mesh, int cell, int node)
{
  int v;

  for (v = 0; v < Vertices(mesh); v++)
    if (mesh->cell[cell * Vertices(mesh) + v] == node) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Halves the longest edge of a random cell, and all cells at that edge. */
static PetscErrorCode Bisect(Mesh *mesh)
{
  int m = Vertices(mesh), old = mesh->cells, c = Below(old), v, w, a = 0, b = 0, d;

  PetscFunctionBeginUser;
  for (v = 0; v < m; v++)
    for (w = 0; w < v; w++) {
      int s = mesh->cell[c * m + v], t = mesh->cell[c * m + w];

      if (Length(mesh, s, t) > Length(mesh, a, b)) a = s, b = t;
    }
  PetscCall(PetscRealloc(3 * (mesh->nodes + 1) * sizeof(PetscReal), &mesh->x));
  PetscCall(PetscRealloc(2 * old * m * sizeof(int), &mesh->cell));
  for (d = 0; d < 3; d++) mesh->x[3 * mesh->nodes + d] = 0.5 * (mesh->x[3 * a + d] + mesh->x[3 * b + d]);
  for (c = 0; c < old; c++) {
    if (!Has(mesh, c, a) || !Has(mesh, c, b)) continue;
    for (v = 0; v < m; v++) {
      int *here = mesh->cell + c * m + v, *other = mesh->cell + mesh->cells * m + v;

      *other = *here == a ? mesh->nodes : *here;
      if (*here == b) *here = mesh->nodes;
    }
    mesh->cells++;
  }
  mesh->nodes++;
  PetscFunctionReturn(0);
}

/* A box of cubes, refined at random places and with nodes inside moved a little. */
static PetscErrorCode RandomMesh(int dim, const int n[3], int bisections, Mesh *mesh)
{
  int node, d, k;

  PetscFunctionBeginUser;
  PetscCall(Cubes(dim, n, mesh));
  for (node = 0; node < mesh->nodes; node++)
    for (d = 0; d < dim; d++) {
      PetscReal *x = mesh->x + 3 * node + d;

      if (*x > 0 && *x < n[d]) *x += 0.2 * (Unit() - 0.5);
    }
  for (k = 0; k < bisections; k++) PetscCall(Bisect(mesh));
  PetscFunctionReturn(0);
}

/* Number of common nodes of two cells. */
static int Common(const Mesh *mesh, int c, int d)
{
  int v, n = 0;

  for (v = 0; v < Vertices(mesh); v++) n += Has(mesh, d, mesh->cell[c * Vertices(mesh) + v]);
  return n;
}

/* For each cell, cells with at least `common` of its nodes, as compressed rows. */
static PetscErrorCode Near(const Mesh *mesh, int common, int **start, int **near)
{
  int m = Vertices(mesh), c, v, k, l, n = 0, room = 64, *first, *at;

  PetscFunctionBeginUser;
  PetscCall(PetscCalloc1(mesh->nodes + 2, &first));
  PetscCall(PetscMalloc1(m * mesh->cells, &at));
  for (c = 0; c < m * mesh->cells; c++) first[mesh->cell[c] + 2]++;
  for (c = 0; c <= mesh->nodes; c++) first[c + 1] += first[c];
  for (c = 0; c < m * mesh->cells; c++) at[first[mesh->cell[c] + 1]++] = c / m;
  PetscCall(PetscMalloc1(mesh->cells + 1, start));
  PetscCall(PetscMalloc1(room, near));
  for (c = 0; c < mesh->cells; c++) {
    (*start)[c] = n;
    for (v = 0; v < m; v++) {
      int node = mesh->cell[c * m + v];

      for (k = first[node]; k < first[node + 1]; k++) {
        if (at[k] == c || Common(mesh, c, at[k]) < common) continue;
        for (l = (*start)[c]; l < n && (*near)[l] != at[k]; l++);
        if (l < n) continue;
        if (n == room) PetscCall(PetscRealloc((room *= 2) * sizeof(int), near));
        (*near)[n++] = at[k];
      }
    }
  }
  (*start)[mesh->cells] = n;
  PetscCall(PetscFree(first));
  PetscCall(PetscFree(at));
  PetscFunctionReturn(0);
}

/* Grows `parts` parts from random cells along rows of a graph until every cell has one. A part that is drawn takes one
   of the cells beside it, so that outlines are ragged. */
static PetscErrorCode Grow(int n, const int *start, const int *near, int parts, int *part)
{
  int *front, *ends, c, p, k, left = n;

  PetscFunctionBeginUser;
  PetscCall(PetscMalloc1((size_t)n * parts + 1, &front));
  PetscCall(PetscCalloc1(parts, &ends));
  for (c = 0; c < n; c++) part[c] = -1;
  for (p = 0; p < parts; p++) {
    do c = Below(n);
    while (part[c] >= 0);
    part[c]                    = p;
    front[(size_t)p * n + ends[p]++] = c;
    left--;
  }
  while (left > 0) {
    int *mine, at, found = -1;

    p = Below(parts);
    if (!ends[p]) continue;
    mine = front + (size_t)p * n;
    at   = Below(ends[p]);
    for (k = start[mine[at]]; k < start[mine[at] + 1] && found < 0; k++)
      if (part[near[k]] < 0) found = near[k];
    if (found < 0) {
      mine[at] = mine[--ends[p]];
      for (k = 0, c = 0; c < parts; c++) k += ends[c];
      if (!k) break; /* what is left is not connected to the rest */
      continue;
    }
    part[found]      = p;
    mine[ends[p]++] = found;
    left--;
  }
  for (c = 0; c < n; c++)
    if (part[c] < 0) part[c] = 0;
  PetscCall(PetscFree(front));
  PetscCall(PetscFree(ends));
  PetscFunctionReturn(0);
}

/* Parts of cells. By sides: grown over cells with a common side. By nodes: nodes are grown into parts, and a cell goes
   where most of its nodes are, as METIS's nodal partitions do. Ragged: some cells then go to a part beside them. */
static PetscErrorCode Partition(const Mesh *mesh, const char *how, int parts, int *part)
{
  int       *start, *near, c, k, v, m = Vertices(mesh);
  PetscBool  nodal, ragged;

  PetscFunctionBeginUser;
  PetscCall(PetscStrcmp(how, "nodes", &nodal));
  PetscCall(PetscStrcmp(how, "ragged", &ragged));
  PetscCall(Near(mesh, nodal ? 1 : mesh->dim, &start, &near));
  if (nodal) {
    int *of;
    int *first, *next, n = 0, w;

    /* The graph of the nodes: those of the cells at a node. */
    PetscCall(PetscCalloc1(mesh->nodes + 2, &first));
    for (c = 0; c < m * mesh->cells; c++) first[mesh->cell[c] + 2] += m;
    for (c = 0; c <= mesh->nodes; c++) first[c + 1] += first[c];
    PetscCall(PetscMalloc1(m * m * mesh->cells, &next));
    for (c = 0; c < mesh->cells; c++)
      for (v = 0; v < m; v++)
        for (w = 0; w < m; w++) next[first[mesh->cell[c * m + v] + 1]++] = mesh->cell[c * m + w];
    PetscCall(PetscMalloc1(mesh->nodes, &of));
    PetscCall(Grow(mesh->nodes, first, next, parts, of));
    for (c = 0; c < mesh->cells; c++) {
      int best = -1, most = 0;

      for (v = 0; v < m; v++) {
        for (w = n = 0; w < m; w++) n += of[mesh->cell[c * m + w]] == of[mesh->cell[c * m + v]];
        if (n > most) most = n, best = of[mesh->cell[c * m + v]];
      }
      part[c] = best;
    }
    PetscCall(PetscFree(of));
    PetscCall(PetscFree(first));
    PetscCall(PetscFree(next));
  } else PetscCall(Grow(mesh->cells, start, near, parts, part));
  PetscCall(PetscFree(start));
  PetscCall(PetscFree(near));
  if (ragged) {
    PetscCall(Near(mesh, 1, &start, &near));
    for (k = 0; k < mesh->cells / 10; k++) {
      c       = Below(mesh->cells);
      part[c] = part[near[start[c] + Below(start[c + 1] - start[c])]];
    }
    PetscCall(PetscFree(start));
    PetscCall(PetscFree(near));
  }
  PetscFunctionReturn(0);
}

/* Gradients of the linear functions of a cell; returns its volume. */
static PetscReal Gradients(const Mesh *mesh, int c, PetscReal g[4][3])
{
  int       dim = mesh->dim, m = dim + 1, i, j, k;
  PetscReal a[3][6], det = 1;

  for (i = 0; i < dim; i++)
    for (j = 0; j < dim; j++) {
      a[i][j]       = mesh->x[3 * mesh->cell[c * m + i + 1] + j] - mesh->x[3 * mesh->cell[c * m] + j];
      a[i][dim + j] = i == j;
    }
  for (i = 0; i < dim; i++) { /* Gauss-Jordan */
    int best = i;

    for (k = i; k < dim; k++)
      if (PetscAbsReal(a[k][i]) > PetscAbsReal(a[best][i])) best = k;
    if (best != i) det = -det;
    for (j = 0; j < 2 * dim; j++) {
      PetscReal t = a[i][j];

      a[i][j]    = a[best][j];
      a[best][j] = t;
    }
    det *= a[i][i];
    for (j = 2 * dim - 1; j >= 0; j--) a[i][j] /= a[i][i];
    for (k = 0; k < dim; k++) {
      PetscReal t = a[k][i];

      if (k != i)
        for (j = 0; j < 2 * dim; j++) a[k][j] -= t * a[i][j];
    }
  }
  for (j = 0; j < dim; j++) {
    g[0][j] = 0;
    for (i = 0; i < dim; i++) {
      g[i + 1][j] = a[j][dim + i];
      g[0][j] -= g[i + 1][j];
    }
  }
  return PetscAbsReal(det) / (dim == 3 ? 6 : 2);
}

/* The matrix of a cell, by nodes and then components: a Laplacian, or elasticity with nu = 0.3 and E = 1. */
static void Stiffness(const Mesh *mesh, int c, int components, PetscScalar *k)
{
  int       m = mesh->dim + 1, n = m * components, a, b, i, j, d;
  PetscReal g[4][3], volume = Gradients(mesh, c, g), lambda = 0.3 / (1.3 * 0.4), mu = 1 / 2.6;

  for (a = 0; a < m; a++)
    for (b = 0; b < m; b++) {
      PetscReal dot = 0;

      for (d = 0; d < mesh->dim; d++) dot += g[a][d] * g[b][d];
      for (i = 0; i < components; i++)
        for (j = 0; j < components; j++) {
          PetscReal value = lambda * g[a][i] * g[b][j] + mu * (g[a][j] * g[b][i] + (i == j) * dot);

          if (components == 1) value = dot;
          k[(a * components + i) * n + b * components + j] = volume * value;
        }
    }
}
