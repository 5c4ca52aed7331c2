// Instruments an estimator to record what it computes, without changing the chapters' shaders.
#pragma once
#include <string>

namespace lab {

// Inserts calls of record_throughput(), record_radiance() or record_survival() (shaders/observation/record_path/path_trace.glsl)
// into the text of a shader: after every statement that starts with `throughput` or `radiance`, members of a struct included, or
// that declares and initialises one of them or `survival_probability`. All lines keep their numbers.
std::string add_recording_calls(const std::string& text);

}  // namespace lab
