#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.hdr";

void read_hostile_file(const std::filesystem::path& file) { read_radiance(file); }

}  // namespace lab
