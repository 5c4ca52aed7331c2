// Chapter 9, low-discrepancy points: the samples of a pixel know of each other, and each goes where the others have left
// a gap.
//
// Random points clump. The points of Sobol's sequence do not: of its first 2^k points each rectangle of area 2^-k, however
// its 2^-i × 2^(i-k) lies in the grid, holds exactly one. Owen scrambling moves them at random and keeps this property.
// Each point alone becomes uniform, so that the estimator stays unbiased. A path needs many pairs of numbers: each is a
// point of the same sequence, with scrambles and an order of its own, so that the pairs do not depend on each other.
//
// Code that asks for random numbers stays as it is: only their source changes, which is random_words.glsl in this folder.
#include "08_light_probes/path_trace.glsl"
