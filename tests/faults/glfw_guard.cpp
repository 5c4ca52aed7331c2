// Preload this to end any program that starts GLFW: proof that headless runs never do.
#include <cstdlib>

extern "C" int glfwInit() { std::_Exit(77); }
