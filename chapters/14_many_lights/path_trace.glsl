// Chapter 14, many lights: light samples go to the lights that matter at x_k.
//
// Until now a light sample chose a triangle by its power alone, wherever x_k is. With thousands of lamps most of these are far
// away or turned away. Here the triangles are the leaves of a tree. Each node knows a sphere around its triangles, the mean of
// their normals and how far these differ from it, and their power. From these and x_k follows its importance, an estimate of
// power · cos θ' · cos θ / r². A light sample descends from the root, and each time chooses one of four children with
// probabilities proportional to their importance.
//
// Light samples and bounces stay the same: only the choice of the triangle changes, choose_light.glsl in this folder, and with it
// the density that a path weighs its bounces by. It depends on x_k, so the path remembers x_{k-1}.
#include "08_light_probes/path_trace.glsl"
