// Whether two ways to render a scene have the same expected image.
#pragma once
#include <string>
#include <vector>

#include "support/render.h"

namespace lab {

// Largest biases that may go unnoticed, relative to the mean radiance of the whole image.
struct AgreementLimits {
    double image;
    double tile;
};

// Expects batches rendered with different seeds to agree: the whole images, and tiles of 8 x 8 pixels (sharing the significance
// of one test). Returns the tiles' p-values in the green channel, which are uniform if the images are equal.
std::vector<double> expect_agreement(const std::string& what, const Batches& image, const Batches& oracle,
                                     const AgreementLimits& limits);

}  // namespace lab
