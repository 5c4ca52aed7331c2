// Instruments an estimator to record what it computes. The chapters' shaders stay as they are.
#pragma once
#include <string>

namespace lab {

// The text of a shader with a call of record_throughput(), record_radiance() or record_survival(), see
// shaders/observation/record_path.glsl, after every statement that begins with `throughput` or `radiance`, which may be members
// of a struct, or declares one of them or `survival_probability` with a value. All lines keep their numbers.
std::string add_recording_calls(const std::string& text);

}  // namespace lab
