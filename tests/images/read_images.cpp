// read_images FILE...: writes what our readers make of each image to FILE.pixels: width, height, then RGBA in bytes or RGB in
// 32-bit floats. Prints the message of each file that is refused.
#include <cstdio>

#include "error.h"
#include "files/file.h"
#include "image/encoding.h"
#include "image/image.h"

namespace lab {
namespace {

template <typename Picture>
void write_pixels(const std::filesystem::path& file, const Picture& picture) {
    std::string bytes = little_endian(picture.width) + little_endian(picture.height);
    bytes.append(reinterpret_cast<const char*>(picture.pixels.data()), picture.pixels.size() * sizeof picture.pixels[0]);
    write_file(file.string() + ".pixels", bytes);
}

void read(const std::filesystem::path& file) {
    std::vector<std::string> notes;
    if (file.extension() == ".hdr")
        write_pixels(file, read_radiance(file, notes));
    else
        write_pixels(file, read_texture(file));
}

}  // namespace
}  // namespace lab

int main(int count, char** names) {
    for (int i = 1; i < count; ++i) try {
            lab::read(names[i]);
        } catch (const lab::UserError& error) {
            std::printf("%s\n", error.what());
        }
}
