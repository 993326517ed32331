/* Scotch's nested dissection. */
#include "ordering.h"

#if defined(FF_HAVE_SCOTCH)
  #include <stdio.h>
  #include <stdint.h>
  #if __has_include(<scotch/scotch.h>)
    #include <scotch/scotch.h>
  #else
    #include <scotch.h>
  #endif

int ff_have_scotch(void)
{
  return sizeof(SCOTCH_Num) == sizeof(int);
}

static int order_graph(SCOTCH_Graph *graph, SCOTCH_Num *order)
{
  SCOTCH_Strat strategy;
  int          failed;

  if (SCOTCH_stratInit(&strategy)) return FF_NO_MEMORY;
  failed = SCOTCH_graphOrder(graph, &strategy, NULL, order, NULL, NULL, NULL);
  SCOTCH_stratExit(&strategy);
  return failed ? FF_FAILED : 0;
}

int ff_scotch_order(int n, const int *row, const int *col, int *order)
{
  SCOTCH_Graph graph;
  int          result;

  if (!ff_have_scotch()) return FF_ABSENT;
  /* Resets the random numbers: the result does not depend on earlier calls. */
  SCOTCH_randomReset();
  if (SCOTCH_graphInit(&graph)) return FF_NO_MEMORY;
  if (SCOTCH_graphBuild(&graph, 0, n, (const SCOTCH_Num *)row, NULL, NULL, NULL, row[n], (const SCOTCH_Num *)col,
                        NULL)) {
    SCOTCH_graphExit(&graph);
    return FF_FAILED;
  }
  #if SCOTCH_VERSION >= 7
  /* Without this Scotch 7 starts a thread per core, and the result depends on their number. */
  SCOTCH_Context context;
  SCOTCH_Graph   bound;

  result = FF_FAILED;
  if (!SCOTCH_contextInit(&context)) {
    SCOTCH_contextOptionSetNum(&context, SCOTCH_OPTIONNUMDETERMINISTIC, 1);
    SCOTCH_contextRandomReset(&context);
    if (!SCOTCH_contextThreadSpawn(&context, 1, NULL) && !SCOTCH_contextBindGraph(&context, &graph, &bound)) {
      result = order_graph(&bound, (SCOTCH_Num *)order);
      SCOTCH_graphExit(&bound);
    }
    SCOTCH_contextExit(&context);
  }
  #else
  result = order_graph(&graph, (SCOTCH_Num *)order);
  #endif
  SCOTCH_graphExit(&graph);
  return result;
}

#else

int ff_have_scotch(void)
{
  return 0;
}
int ff_scotch_order(int n, const int *row, const int *col, int *order)
{
  return FF_ABSENT;
}
#endif
