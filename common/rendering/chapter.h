// A chapter is a folder of chapters/: chapter.json, which describes it, and its shader path_trace.glsl.
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
    double low, high;  // accepted range, both ends included
};

// An option that the shader is compiled with: --facet-sampling becomes the define FACET_SAMPLING.
// The default is not defined: the shader states it with #ifndef, so that it also compiles alone.
struct ChapterChoice {
    std::string name;  // "--facet-sampling"
    std::string help;
    std::vector<std::pair<std::string, std::string>> values;  // on the command line and in the shader, the default first
    std::string shows = {};         // what the picture shows instead of radiance, unless it has the default; empty if radiance
    bool chooses_material = false;  // the values after the default are the scene's materials, in its order
    std::vector<uint32_t> passes = {};  // of filter.glsl for each value, if this chooses a filter of the finished picture

    bool is_filter() const { return !passes.empty(); }

    std::string define() const;
};

// The contents of chapter.json, under the same names. Only the title is mandatory. It may also have "check", for ./lab check: the
// "samples" of a run, the "references" whose scenes show what the shader can do, and those that the exercise's placeholder
// passes; "exercise", for ./lab handout: the lines that a student fills in; "tests", see tests/support/chapters.h; and "measure",
// for figures and tables, see tools/report/studies.py. "options" are names of those that chapter.cpp knows, such as
// "--survival-cap".
struct Chapter {
    std::string name;                           // of its folder
    std::string title;                          // shown by --help
    std::string continues = {};                 // the chapter where files are looked up that this one lacks, see tracer.h
    std::string default_scene = "cornell_box";  // in assets/scenes
    std::vector<Strategy> strategies = {};      // of --strategy, the default first; if none, only bounces find light
    bool unlimited_path_length = false;         // unless the scene or --max-path-length limits it
    Capabilities handles = {};                  // keys of their own
    bool low_discrepancy = false;               // brings its own points, random_words.glsl, which are not independent
    std::vector<ChapterOption> options = {};
    std::vector<ChapterChoice> choices = {};
};

// Names of the folders in chapters/ that hold a chapter, sorted.
std::vector<std::string> chapter_folders();

// Loads the chapter in a folder of chapters/. Throws UserError if its chapter.json is missing or wrong, naming the key and what
// is possible.
Chapter load_chapter(const std::string& name);

}  // namespace lab
