// Chapter 9, low-discrepancy points: the samples of a pixel know about each other, and each fills a gap that the others have
// left.
//
// Random points clump. The points of Sobol's sequence do not: every rectangle of size 2^-i × 2^(i-k) in the grid holds exactly
// one of its first 2^k points. Owen scrambling moves the points at random and keeps this property. Each point by itself becomes
// uniform, so the estimator stays unbiased. A path needs many pairs of numbers: each pair is a point of the same sequence, with
// its own scrambles and its own order, so that the pairs are independent of each other.
//
// Code that asks for random numbers stays the same: only their source changes, random_words.glsl in this folder.
#include "08_light_probes/path_trace.glsl"
