// Preloaded, it ends any program that starts GLFW: proof that a run without a window never does.
#include <cstdlib>

extern "C" int glfwInit() { std::_Exit(77); }
