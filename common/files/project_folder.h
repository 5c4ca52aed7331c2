// Where the project is.
#pragma once
#include <filesystem>

namespace lab {

// The folder that holds shaders/ and assets/, searched upwards from the running program. Throws UserError if there is none.
std::filesystem::path project_folder();

}  // namespace lab
