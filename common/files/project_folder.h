// Where the project lies.
#pragma once
#include <filesystem>

namespace lab {

// The folder that holds shaders/ and assets/, found upwards from the running program. Throws UserError if there is none.
std::filesystem::path project_folder();

}  // namespace lab
