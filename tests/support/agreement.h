// Whether two ways to render a scene have the same expected image.
#pragma once
#include <string>
#include <vector>

#include "support/render.h"

namespace lab {

// Largest biases that may go unnoticed, as parts of the mean radiance of the whole image.
struct AgreementLimits {
    double image;
    double tile;
};

// Batches rendered with different seeds agree: the whole images, and tiles of 8 x 8 pixels (both with the
// significance of one test). Returns the tiles' p-values in the green channel, uniform where images are
// equal.
std::vector<double> expect_agreement(const std::string& what, const Batches& image, const Batches& oracle,
                                     const AgreementLimits& limits);

}  // namespace lab
