// The parts of the stb libraries that Debian's Dear ImGui needs to draw text. Debian's own build of them includes the image
// readers, which are compiled here with bounds on their memory.
#define STB_RECT_PACK_IMPLEMENTATION
#define STB_TRUETYPE_IMPLEMENTATION
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_rect_pack.h>
#include <stb_truetype.h>
#pragma GCC diagnostic pop
