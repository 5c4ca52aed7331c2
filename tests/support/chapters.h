// The chapters as tests see them: by name and by what their chapter.json says, never by number.
#pragma once
#include <string>
#include <vector>

#include "rendering/chapter.h"
#include "support/course_chapters.h"

namespace lab {

// The chapters whose estimators are tested.
inline const std::vector<std::string> all_chapters = course_chapters();

// The folder of the chapter with this name: chapter_named("cosine_sampling") for "cosine_sampling".
std::string chapter_named(const std::string& name);

// What a chapter supports.
bool samples_lights(const std::string& chapter);
bool weights_lights(const std::string& chapter);  // light samples and bounces share the light by weights
bool handles_dielectrics(const std::string& chapter);
bool handles_microfacets(const std::string& chapter);
bool has_light_paths(const std::string& chapter);
bool has_option(const std::string& chapter, const std::string& option);
bool splits_paths(const std::string& chapter);
bool has_roulette(const std::string& chapter);
// Whether its random numbers come straight from the generator, so that the generator's states determine them.
bool is_pseudorandom(const std::string& chapter);

// From "tests" in its chapter.json. Whether bounces off a Lambertian surface always have the weight of its albedo.
bool weighs_by_albedo(const std::string& chapter);
// Whether it follows the paths of another chapter, apart from what it adds, so that testing that one is enough.
bool repeats_another(const std::string& chapter);

// The chapters that have all of these abilities.
template <typename... Abilities>
std::vector<std::string> chapters_that(const Abilities&... abilities) {
    std::vector<std::string> chapters;
    for (const std::string& chapter : all_chapters)
        if ((abilities(chapter) && ...)) chapters.push_back(chapter);
    return chapters;
}

// First seed of a chapter: chapters may follow the same paths if their seeds are equal, so tests that must be independent of each
// other start at different ones. A multiple of 1000, below 2^16.
uint32_t chapter_seed(const std::string& chapter);

// An image that a chapter is compared with: an entry of "references" there.
struct ReferenceCase {
    std::string chapter;
    std::string reference;     // in assets/references: scene and maximal path length
    uint32_t samples;          // per batch
    double largest_bias;       // of the image's mean that may go unnoticed
    double largest_tile_bias;  // likewise for a tile, relative to the image's mean
    bool has_heavy_tail;       // rare bright samples
    bool runs_with_all;        // only with ./lab test --all
};
std::vector<ReferenceCase> reference_cases();

// A chapter that equals the previous one when its addition is left out: "repeats" there.
struct Repetition {
    std::string chapter, before;
    std::vector<std::string> without;  // "splitting", "roulette", "glass" or "probe"

    bool has(const std::string& what) const;
};
std::vector<Repetition> repetitions();

}  // namespace lab
