// Chapter 12, a lens: what is not in focus becomes a disc.
//
// A pinhole sees every point through the same point. A lens sees it through each point of its aperture, and bends the light so
// that all rays through one point of the image meet again at one point of the plane in focus. Points before or behind that plane
// reach many pixels. So the camera's ray starts at a random point of the aperture, see camera.glsl in this folder, and the rest of
// the path is that of chapter 11.
#include "11_microfacets/path_trace.glsl"
