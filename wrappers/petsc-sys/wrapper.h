/* What bindgen reads: the public headers of the classes that fetifeti uses, and our own. */
#include <petscksp.h>
#include <slepceps.h>
#include "shim.h"
