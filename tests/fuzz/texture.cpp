#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.png";  // PNG, JPG, BMP and TGA are told apart by their contents

void read_hostile_file(const std::filesystem::path& file) { read_texture(file); }

}  // namespace lab
