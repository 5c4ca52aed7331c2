// Chapters that another program was built for.
#pragma once
#include "rendering/chapter.h"

namespace lab {

// Names of the folders in chapters/ that hold an estimator, in order.
std::vector<std::string> chapter_folders();

// What the estimator in a folder of chapters/ needs, seen from its text: its main.cpp is part of another
// program. Throws UserError if there is none.
Chapter chapter_in_folder(const std::string& name);

}  // namespace lab
