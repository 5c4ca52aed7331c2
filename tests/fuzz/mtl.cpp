#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.mtl";

// A mesh of the seeds that refers to the input and uses its materials.
void read_hostile_file(const std::filesystem::path& file) { use_scene(load_scene(file.parent_path() / "materials.obj", true)); }

}  // namespace lab
