#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.obj";

void read_hostile_file(const std::filesystem::path& file) { use_scene(load_scene(file, true)); }

}  // namespace lab
