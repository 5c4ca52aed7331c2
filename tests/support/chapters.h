// The chapters as tests see them: by name and by what chapter.json says, never by number.
#pragma once
#include <string>
#include <vector>

#include "rendering/chapter.h"

namespace lab {

// The chapters whose estimators are tested, in order.
inline const std::vector<std::string> all_chapters = course_chapters();

// The folder of the chapter with this name: chapter_named("cosine_sampling") for "cosine_sampling".
std::string chapter_named(const std::string& name);

// What a chapter can do.
bool samples_lights(const std::string& chapter);
bool weights_lights(const std::string& chapter);  // light samples and bounces share the light
bool handles_dielectrics(const std::string& chapter);
bool handles_microfacets(const std::string& chapter);
bool has_option(const std::string& chapter, const std::string& option);
bool splits_paths(const std::string& chapter);
bool has_roulette(const std::string& chapter);
// Whether its random numbers are the generator's: its states decide what they do.
bool is_pseudorandom(const std::string& chapter);

// What tests.json in its folder says. Whether bounces off a Lambertian surface have the weight of its albedo
// and no other.
bool weighs_by_albedo(const std::string& chapter);
// Whether it is another chapter path by path, but for what it adds, so that tests of that one are enough.
bool repeats_another(const std::string& chapter);

// The chapters for which all of these hold.
template <typename... Abilities>
std::vector<std::string> chapters_that(const Abilities&... abilities) {
    std::vector<std::string> chapters;
    for (const std::string& chapter : all_chapters)
        if ((abilities(chapter) && ...)) chapters.push_back(chapter);
    return chapters;
}

// Chapters may follow the same paths if their seeds are equal: tests that are to be independent of each other
// begin at this one. A multiple of 1000, below 2^16.
uint32_t chapter_seed(const std::string& chapter);

// An image that a chapter is compared with: an entry of "references" in tests.json.
struct ReferenceCase {
    std::string chapter;
    std::string reference;     // in assets/references: scene and maximal path length
    uint32_t samples;          // of a batch
    double largest_bias;       // of the image's mean, that may go unnoticed
    double largest_tile_bias;  // the same of a tile, as part of the image's mean
    bool has_heavy_tail;       // rare bright samples
    bool runs_with_all;        // only with ./lab test --all
};
std::vector<ReferenceCase> reference_cases();

// A chapter that is the one before it where what it adds is left out: "repeats" in tests.json.
struct Repetition {
    std::string chapter, before;
    std::vector<std::string> without;  // "splitting", "roulette", "glass" or "probe"

    bool has(const std::string& what) const;
};
std::vector<Repetition> repetitions();

}  // namespace lab
