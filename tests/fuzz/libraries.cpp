// The libraries that read files, compiled once more so that the sanitizers see into them.
// NOLINTBEGIN
#include <zlib.h>
#define TINYEXR_USE_MINIZ 0
#define TINYEXR_IMPLEMENTATION
#include <tinyexr.h>
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>
// NOLINTEND
