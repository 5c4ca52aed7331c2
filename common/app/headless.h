// Rendering without a window: from the options to the written files.
#pragma once
#include "app/report.h"
#include "film/film_file.h"
#include "rendering/options.h"
#include "rendering/renderer.h"

namespace lab {

// What a render is: everything that decides its expected image.
struct RenderJob {
    const Options* options;
    RenderParameters parameters;
    uint32_t samples;  // wanted in every pixel
    FilmRecord record;
    std::optional<FilmFile> resumed;  // the run that this one continues
    AccelerationRecord acceleration;
};

// Renders until the samples, the target error or the time limit are reached or Ctrl-C is pressed, then writes
// all outputs and the report and prints a summary. Throws DeviceFailure if the device is lost, after writing
// what was last read from it.
void render_headless(const Device& device, const AccelerationStructure& acceleration_structure,
                     const Estimator& estimator, const RenderJob& job);

}  // namespace lab
