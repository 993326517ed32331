/* What bindgen reads: the public headers of the classes that fetifeti uses, and the shim. */
#include <petscksp.h>
#include <slepceps.h>
#include "shim.h"
