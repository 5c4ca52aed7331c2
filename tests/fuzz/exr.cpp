#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.exr";

void read_hostile_file(const std::filesystem::path& file) { read_radiance(file); }

}  // namespace lab
