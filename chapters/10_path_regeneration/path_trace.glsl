// Chapter 10, path regeneration: no thread waits for the longest path.
//
// The threads of a GPU run in groups, called warps or subgroups, that execute the same instruction together. In chapter 9 a
// thread whose path has ended waits until the longest path of its group has ended, too. Here the loop over bounces and the loop
// over samples are one, see sample_loop.glsl in this folder. So such a thread starts its next sample at once, while its
// neighbours continue theirs (Novák, Havran and Dachsbacher, "Path Regeneration for Interactive Path Tracing", Eurographics
// 2010). Each sample is the same as in chapter 9, to the bit.
#include "08_light_probes/path_trace.glsl"
