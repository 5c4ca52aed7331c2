// Shared by the fuzz targets: turns an input into a file and judges what a loader does with it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "scene/scene.h"

namespace lab {

// Defined by each target (obj.cpp, mtl.cpp, ...): the file name under which its loader sees the input, and the call of the
// loader, which may throw nothing but UserError.
extern const char* const hostile_file_name;
void read_hostile_file(const std::filesystem::path& file);

// Aborts unless all indices of an accepted scene are in range; then does with the scene what a render does on the CPU.
void use_scene(const Scene& scene);

}  // namespace lab

// The entry point that libFuzzer calls with each input. Aborts on anything but success or a UserError of
// one printable line, and on a single allocation above memory_limit().
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);
