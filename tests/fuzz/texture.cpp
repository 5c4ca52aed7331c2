#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.png";  // contents decide whether it is PNG, JPG, BMP or TGA

void read_hostile_file(const std::filesystem::path& file) { read_texture(file); }

}  // namespace lab
