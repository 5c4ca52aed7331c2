// The files that a render leaves behind.
#pragma once
#include <functional>

#include "film/film_file.h"
#include "rendering/options.h"

namespace lab {

// Writes the film in the format that the file's ending asks for. PNG and JPG show it as --view and --exposure
// say.
void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmRecord& record,
                   const Options& options);

// After a failure of the device or of memory: writes the film that was last read, and throws DeviceFailure
// with what has happened first and what is left. Other errors are thrown again.
[[noreturn]] void keep_after(const std::exception& error, const FilmImage& film,
                             const std::function<void()>& write);

// Writes all files, also those after one that cannot be written; then throws the first UserError, if any.
void write_each(const std::vector<std::filesystem::path>& files,
                const std::function<void(const std::filesystem::path&)>& write);

}  // namespace lab
