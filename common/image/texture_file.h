// What stb_image would misread in texture files is refused or rewritten before it sees them.
#pragma once
#include <filesystem>
#include <string>

namespace lab {

struct TextureFile {
    std::string format;          // ".png", ".jpg", ".bmp" or ".tga"; empty if it is none of them
    std::string bytes;           // for stb_image
    bool is_mirrored = false;    // rows start at the right
    bool without_alpha = false;  // its fourth channel has no meaning
};

// Throws UserError for files of a kind that stb_image cannot read, or not within bounded memory and time.
TextureFile prepare_texture(const std::filesystem::path& file, std::string bytes);

}  // namespace lab
