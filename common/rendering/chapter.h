// A chapter is data and a shader: a folder of chapters/ with chapter.json, which says what it is, and path_trace.glsl.
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "shaders/interface.h"
#include "tracing/gpu_scene.h"

namespace lab {

// An option of the estimator: a number among the render parameters.
struct ChapterOption {
    std::string name;  // "--survival-cap"
    std::string help;
    std::variant<uint32_t RenderParameters::*, float RenderParameters::*> parameter;
    double default_value;
    double low, high;  // what is accepted, both included
};

// An option of the estimator that its shader is compiled with: --facet-sampling is the define FACET_SAMPLING.
struct ChapterChoice {
    std::string name;  // "--facet-sampling"
    std::string help;
    std::vector<std::pair<std::string, std::string>> values;  // on the command line and in the shader, the default first

    std::string define() const;
};

// What chapter.json says, under the same names. Only the title must be there. It may also have "check", for ./lab check: the
// "samples" of a run, and the "references" whose scenes show what the shader does.
struct Chapter {
    std::string name;                           // of its folder
    std::string title;                          // shown by --help
    std::string default_scene = "cornell_box";  // in assets/scenes
    std::vector<Strategy> strategies = {};      // of --strategy, the default first; if none, bounces find light
    bool light_probe_sampling = false;          // light samples go to a probe, too
    bool unlimited_path_length = false;         // whatever the scene says; --max-path-length still limits it
    bool dielectrics = false;                   // whether its estimator handles them
    bool microfacets = false;                   // the same of rough metal, plastic and glass (Pr)
    bool low_discrepancy = false;               // has points of its own, random_words.glsl, that depend on each other
    std::vector<ChapterOption> options = {};
    std::vector<ChapterChoice> choices = {};
};

// Names of the folders in chapters/ that hold a chapter, in order.
std::vector<std::string> chapter_folders();

// The same without copies, in which people try things: of chapters with the same title only the first.
std::vector<std::string> course_chapters();

// The chapter in a folder of chapters/. Throws UserError if its chapter.json is missing or wrong, with the key and what is
// possible.
Chapter load_chapter(const std::string& name);

}  // namespace lab
