#include "12_lens/camera.glsl"
