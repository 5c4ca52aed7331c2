// A chapter is data and a shader.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "shaders/interface.h"

namespace lab {

// An option of the estimator: a number among the render parameters.
struct ChapterOption {
    std::string name;  // "--survival-cap"
    std::string help;
    std::variant<uint32_t RenderParameters::*, float RenderParameters::*> parameter;
    double default_value;
    double low, high;  // what is accepted, both included
};

struct Chapter {
    std::string name;                           // of its folder: LAB_CHAPTER
    std::string title;                          // shown by --help
    std::string default_scene = "cornell_box";  // in assets/scenes
    bool light_sampling = false;                // has --light-sampling
    bool split_every_hit = false;        // has --split-every-hit, which renders path_trace_every_hit.glsl
    bool unlimited_path_length = false;  // whatever the scene says; --max-path-length still limits it
    bool dielectrics = false;            // whether its estimator handles them
    std::vector<ChapterOption> options = {};
};

// Options that several chapters have. The defaults are measured, see docs/results.md.
inline const ChapterOption splitting_factor{.name = "--splitting-factor",
                                            .help = "Branches in which a path goes on",
                                            .parameter = &RenderParameters::splitting_factor,
                                            .default_value = 4,
                                            .low = 1,
                                            .high = 1024};
inline const ChapterOption survival_cap{
    .name = "--survival-cap",
    .help = "Largest survival probability of Russian roulette; with 1, paths among white walls never end",
    .parameter = &RenderParameters::survival_cap,
    .default_value = 0.95,
    .low = 0.001,
    .high = 1};
inline const ChapterOption roulette_start{.name = "--roulette-start",
                                          .help = "Bounce at which Russian roulette begins",
                                          .parameter = &RenderParameters::roulette_start,
                                          .default_value = 3,
                                          .low = 1,
                                          .high = 1000000};

}  // namespace lab
