// The film as an OpenEXR file: picture, settings and checkpoint in one.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "film/film_image.h"

namespace lab {

// How a film was made, as string attributes of the EXR.
struct FilmHeader {
    std::string chapter;
    std::string scene;           // file name
    std::string scene_hash;      // of all its files
    std::string estimator_hash;  // of the shaders that it is compiled from
    std::string settings;        // the options that change the expected image, in a fixed order
    std::string shows;           // what the picture shows instead of radiance; empty if it shows radiance
    std::string backend;
    std::string device;
    std::string filter = {};  // that has run over the picture; empty without one
    uint32_t seed = 0;
    uint32_t first_sample = 0;
    uint64_t rays = 0;
    double seconds = 0;  // of rendering
};

// The attribute `samples` is the smallest sample count of any pixel; after an interrupted render the channel `further_samples`
// holds what pixels have beyond it. The channels `difference.R`, … hold the contribution of a pixel's first, third, … sample to
// the picture minus that of the others: for an even number of samples its absolute value is the standard error. The channel
// `invalid_samples` counts invalid samples, if any.
void write_film(const std::filesystem::path& file, const FilmImage& image, const FilmHeader& header);

struct FilmFile {
    FilmImage image;
    FilmHeader header;
};

// Throws UserError if write_film() did not write the file.
FilmFile read_film(const std::filesystem::path& file);

// Throws UserError if size, chapter, scene, shader, settings or seed differ. The names appear in the message.
void require_same_render(const FilmFile& a, const FilmFile& b, const std::string& name_a, const std::string& name_b);

// Joins renders of adjacent sample ranges, in any order. Throws UserError for gaps, overlaps, unfinished renders, and renders
// that do not belong together.
FilmFile merge_films(const std::vector<std::filesystem::path>& files);

}  // namespace lab
