// The libraries that read files, compiled again so that the sanitizers cover them.
// NOLINTBEGIN
#include <zlib.h>
#define TINYEXR_USE_MINIZ 0
#define TINYEXR_IMPLEMENTATION
#include <tinyexr.h>
// NOLINTEND
