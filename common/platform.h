// Everything that depends on the operating system.
#pragma once
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <vector>

namespace lab {

// Call this first. Output that nobody reads and files that are too large become errors of the write, which would end the program
// and lose a render. On Windows it switches the terminal to UTF-8 and control sequences, and keeps a terminal opened by a double
// click until Enter is pressed, so that messages can be read.
void prepare_program();

// Whether the stream is a terminal.
bool is_terminal(std::FILE* stream);

// Stops Windows from translating line ends in this stream.
void make_binary(std::FILE* stream);

// Window systems available here, in the order to try them. Empty without a display.
enum class WindowSystem { wayland, x11, other };
std::vector<WindowSystem> window_systems();

// Whether the program would survive a step that may crash. On Linux a child process tries it silently; elsewhere the answer is
// yes.
bool would_survive(int (*step)());

// Path of the running program; empty if unknown.
std::filesystem::path running_program();

// The user's home folder; empty if unknown.
std::filesystem::path user_folder();

int process_id();

// Number of processors that the program may use.
size_t processor_count();

// Processor time that all threads of the program have taken so far.
double processor_seconds();

// Waits until flushed data is on the disk. Returns false on failure, with errno set.
bool write_to_disk(std::FILE* stream);

// Renames a file atomically, replacing an existing one. On Windows a virus scanner may hold a new file open: retries for up to a
// second.
void rename_file(const std::filesystem::path& from, const std::filesystem::path& to, std::error_code& error);

// What to install for Vulkan; follows "install " in messages.
extern const char* const vulkan_driver;

// From now on what asks the program to end makes is_interrupted() true: the first Ctrl-C or SIGTERM, of which the second ends the
// program; a terminal that closes; a limit on processor time. What the caller has set to be ignored is still ignored.
void install_interrupt_handler();
bool is_interrupted();
// From now on they end the program at once.
void remove_interrupt_handler();

}  // namespace lab
