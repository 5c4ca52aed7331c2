// Ctrl-C asks a running render for an orderly end.
#pragma once

namespace lab {

// From now on the first Ctrl-C (or SIGTERM) only makes is_interrupted() true; the second one ends the
// program.
void install_interrupt_handler();
bool is_interrupted();

}  // namespace lab
