#include "rendering/outputs.h"

#include "error.h"
#include "files/file.h"

namespace lab {

void write_picture(const std::filesystem::path& file, const FilmImage& film, const FilmRecord& record,
                   const Options& options) {
    const DisplayTransform transform = options.view ? options.view->display : DisplayTransform::exposure;
    const std::string ending = lower_case_extension(file);
    if (ending == ".exr")
        write_film(file, film, record);
    else if (ending == ".hdr")
        write_hdr(file, film.mean());
    else if (ending == ".png")
        write_png(file, to_display(film, transform, options.exposure));
    else
        write_jpg(file, to_display(film, transform, options.exposure));
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
