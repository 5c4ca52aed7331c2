#include "rendering/outputs.h"

#include "error.h"
#include "files/file.h"
#include "gpu/failure.h"

namespace lab {

void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmRecord& record,
                   const Options& options) {
    const std::string ending = lower_case_extension(file);
    if (ending == ".exr")
        write_film(file, film, record);
    else if (ending == ".hdr")
        write_hdr(file, film.mean());
    else if (ending == ".png")
        write_png(file, to_display(film, options.image.display(), options.appearance.exposure));
    else
        write_jpg(file, to_display(film, options.image.display(), options.appearance.exposure));
}

void keep_after(const std::exception& error, const FilmImage& film, const std::function<void()>& write) {
    const Failure failure = failure_of(error);
    if (failure.exit_code != 3) throw;
    if (film.min_samples() == 0 && film.has_equal_sample_counts())
        throw DeviceFailure(failure.message + ": there was nothing to write yet");
    try {
        write();
    } catch (const UserError& unwritten) {
        throw DeviceFailure(failure.message + "; " + unwritten.what());
    }
    throw DeviceFailure(failure.message + ": the outputs hold " + std::to_string(film.min_samples()) +
                        " samples a pixel; --resume continues");
}

void write_each(const std::vector<std::filesystem::path>& files,
                const std::function<void(const std::filesystem::path&)>& write) {
    std::optional<UserError> failure;
    for (const auto& file : files) try {
            write(file);
        } catch (const UserError& error) {
            if (!failure) failure = error;
        }
    if (failure) throw *failure;
}

}  // namespace lab
