// Chapter 15, light paths: what if a path began at the lamp?
//
// A camera path finds a caustic only if one of its bounces goes through the glass and happens to hit the lamp: the smaller the lamp,
// the rarer that is. Light samples never find it, since glass refracts into one direction only. A path that begins at the lamp finds
// the glass easily, and where it meets a matte surface behind it, that surface sends light to the camera in a known direction.
//
// Light is divided, not weighted: see partition.glsl in this folder. A light path reaches other pixels than its own, so its light
// goes to them by add_splat(). Without lamps and glass, and in media, the paths are those of chapter 14.
#include "08_light_probes/path_trace.glsl"
