// What the fuzz targets share: an input becomes a file, and what a loader does with that file is judged.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>

#include "scene/scene.h"

namespace lab {

// Defined by each target (obj.cpp, mtl.cpp, ...): the name under which its loader sees the input, and the
// call of the loader. Only a UserError may come out of it.
extern const char* const hostile_file_name;
void read_hostile_file(const std::filesystem::path& file);

// Ends the program unless all indices of an accepted scene are in range; then does with the scene what a
// render does on the CPU.
void use_scene(const Scene& scene);

}  // namespace lab

// The entry that libFuzzer and mutation_driver.cpp call with each input. Ends the program for anything but
// success or a UserError of one printable line, and for a single allocation above memory_limit().
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);
