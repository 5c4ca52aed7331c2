#include "hostile_input.h"

namespace lab {

const char* const hostile_file_name = "input.hdr";

void read_hostile_file(const std::filesystem::path& file) {
    std::vector<std::string> notes;
    read_radiance(file, notes);
}

}  // namespace lab
